"""What a start does not wait for: each is imported only by who uses it."""

import json
import os
import subprocess
import sys

import pytest
from outputs import create, write
from scenes import CONFIGS

from rodsim.output import CaseText

VALIDATE = """
import sys
from rodsim.case import load_case
from rodsim.scene.build import build_scene
build_scene(load_case(sys.argv[1]))
print(sorted({"h5py", "numba", "rodsim.output.reader"} & set(sys.modules)))
"""
LATE = """
import sys
from rodsim.case import Case, load_case
for path in sys.argv[1:]:
    load_case(path)
    print("_adapter" in vars(Case.model_fields["contact"].metadata[0]))
"""
COMPILED = """
import sys
from rodsim.compiled.settings import prepare
prepare()
from rodsim.compiled.rotations import displace
print(displace.stats.cache_hits and "numba.np.arraymath" in sys.modules, "scipy" in sys.modules)
"""
INFO = """
import sys
from pathlib import Path
from rodsim.commands.stored_run import describe_output
print("viscosity 0.0027 g um^-1 s^-1 (2700 mPa s)" in describe_output(Path(sys.argv[1])))
print(sorted({"pydantic", "numba", "yaml", "rodsim.case.model"} & set(sys.modules)))
"""
END = """
import atexit, gc, sys
atexit.register(lambda: print(gc.get_freeze_count() > len(sys.modules)))
sys.argv = ["rodsim", "validate", sys.argv[1]]
from rodsim.__main__ import main
main()
"""


PLUGINS = """
import os, sys
sys.argv = ["rodsim", "validate", sys.argv[1]]
from rodsim.__main__ import main
try:
    main()
finally:
    from pydantic.plugin._loader import get_plugins
    print(os.environ["PYDANTIC_DISABLE_PLUGINS"], list(get_plugins()))
"""


def said_by(code, *arguments):
    command = [sys.executable, "-c", code, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_a_case_is_checked_without_numba_and_hdf5():
    assert said_by(VALIDATE, CONFIGS / "closed_ring.yaml") == "[]"


def test_the_validator_of_a_word_is_made_when_a_case_has_it():
    said = said_by(LATE, CONFIGS / "closed_ring.yaml", CONFIGS / "plectoneme.yaml")
    assert said.split() == ["False", "True"]


def test_an_output_is_described_without_what_reads_a_case(tmp_path):
    rod = {"moduli": {"bending": [0.3, "0.2 + s"], "twisting": 0.2, "shear": 0.7, "stretch": 0.9}}
    case = {
        "title": "a t that is no time",
        "fluid": {"viscosity": 2.7e-3, "blob": "algebraic7", "epsilon": {"spacings": 3.0}},
        "rods": {"zeta": rod, "alpha": rod},
        "time": {"end": 1.7, "integrator": "rkc", "tolerance": 1e-5},
    }
    text = CaseText("", json.dumps(case), [])
    with create(tmp_path / "out.h5", case=text) as writer:
        write(writer, range(3))
        writer.finish("finished", {})
    assert said_by(INFO, tmp_path / "out.h5").splitlines() == ["True", "[]"]


def test_plugins_of_pydantic_are_not_looked_for():
    said = said_by(PLUGINS, CONFIGS / "closed_ring.yaml")
    assert said.splitlines()[-1] == "__all__ []"


@pytest.mark.compiled
def test_compiled_code_is_read_without_what_compiles():
    assert "NUMBA_CACHE_DIR" in os.environ
    said_by(COMPILED)  # compiles, where the cache is new
    assert said_by(COMPILED) == "False False"


def test_the_end_of_the_command_does_not_look_for_garbage():
    assert said_by(END, CONFIGS / "closed_ring.yaml").splitlines()[-1] == "True"
