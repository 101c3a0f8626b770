"""What a start does not wait for: each is imported only by who uses it."""

import os
import subprocess
import sys

import pytest
from scenes import CONFIGS

VALIDATE = """
import sys
from rodsim.case import load_case
from rodsim.scene.build import build_scene
build_scene(load_case(sys.argv[1]))
print(sorted({"h5py", "numba", "rodsim.output.reader"} & set(sys.modules)))
"""
COMPILED = """
import sys
from rodsim.compiled.settings import prepare
prepare()
from rodsim.compiled.rotations import displace
print(displace.stats.cache_hits and "numba.np.arraymath" in sys.modules, "scipy" in sys.modules)
"""
END = """
import atexit, gc, sys
atexit.register(lambda: print(gc.get_freeze_count() > len(sys.modules)))
sys.argv = ["rodsim", "validate", sys.argv[1]]
from rodsim.__main__ import main
main()
"""


def said_by(code, *arguments):
    command = [sys.executable, "-c", code, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_a_case_is_checked_without_numba_and_hdf5():
    assert said_by(VALIDATE, CONFIGS / "closed_ring.yaml") == "[]"


@pytest.mark.compiled
def test_compiled_code_is_read_without_what_compiles():
    assert "NUMBA_CACHE_DIR" in os.environ
    said_by(COMPILED)  # compiles, where the cache is new
    assert said_by(COMPILED) == "False False"


def test_the_end_of_the_command_does_not_look_for_garbage():
    assert said_by(END, CONFIGS / "closed_ring.yaml").splitlines()[-1] == "True"
