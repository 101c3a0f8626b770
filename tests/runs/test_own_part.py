"""A part that is defined in a file of its own: the one that docs/own-parts.md shows."""

import csv
import os
import re
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from contents import differences
from scenes import ROOT

PAGE = (ROOT / "docs" / "own-parts.md").read_text(encoding="utf-8")
BLOCKS = dict(re.findall(r"```(\w+)\n(.*?)```", PAGE, re.S))  # one of each language
FILES = {"trough.py": BLOCKS["python"], "case.yaml": BLOCKS["yaml"]}
STOP = """
from rodsim import load_case, simulate
from rodsim.run.listener import Listener

class Asking(Listener):
    steps = 0
    def stop(self):
        self.steps += 1
        return "the test" if self.steps == 9 else ""

simulate(load_case("case.yaml"), "stopped.h5", listener=Asking())
"""


@pytest.fixture(scope="module")
def call(tmp_path_factory):
    """Return a function that starts Python in a folder with the files of the page."""
    folder = tmp_path_factory.mktemp("own")
    for name, text in FILES.items():
        (folder / name).write_text(text)
    environment = {**os.environ, "RODSIM_PARTS": "trough", "PYTHONPATH": str(folder)}
    environment.pop("NUMBA_THREADING_LAYER", None)  # of this process, which has loaded tbb

    def call(*arguments, code=0, **changes):
        done = subprocess.run(
            [sys.executable, *arguments], cwd=folder, env={**environment, **changes},
            capture_output=True, text=True,
        )  # fmt: skip
        assert done.returncode == code, done.stderr
        return done

    call.folder = folder
    return call


def rodsim(call, *arguments, **options):
    return call("-m", "rodsim", *arguments, **options)


@pytest.fixture(scope="module")
def whole(call):
    rodsim(call, "run", "case.yaml", "-o", "whole.h5")
    return call.folder / "whole.h5"


def test_it_runs_and_its_work_is_in_the_file(whole):
    with h5py.File(whole) as file:
        seen = {name: file[f"observables/{name}/value"][()] for name in file["observables"]}
        y = file["particles/trajectory/position/value"][..., 1]
        time = file["particles/trajectory/position/time"][()]
    assert (seen["external_work"] == seen["trough_work"]).all()
    weights = 0.11 * np.array([0.5, *10 * [1.0], 0.5])
    force = -2e-4 * (y - 0.4 * np.sin(300 * time)[:, None]) @ weights
    assert seen["external_force"][:, 1] == pytest.approx(force, rel=1e-9, abs=1e-15)
    assert seen["net_force"] == pytest.approx(seen["external_force"], abs=1e-12)
    assert abs(y[-1].mean()) < 0.5 < y[0].mean()
    parts = ("bending", "twisting", "shear", "stretch")
    energy = sum(seen[f"{part}_energy"] for part in parts).sum(axis=1)
    kept = energy[-1] - energy[0] - seen["external_work"][-1] + seen["dissipated"][-1]
    assert abs(kept) < 5e-3 * energy[0]  # O(ds^2), and the time at a tolerance of 1e-4


def test_its_flow_is_that_of_its_loads(call, whole):
    """Far away a rod in a trough is its net force at a point: u = f (1/r + z z/r^3)/(8 pi mu)."""
    rodsim(
        call, "flow", str(whole), "--at", "0", "--raw", "--grid", "0,500:501:2,0.6", "-o", "far.csv"
    )
    with open(call.folder / "far.csv", newline="") as file:
        found = next(csv.DictReader(file))
    with h5py.File(whole) as file:
        force = file["observables/net_force/value"][0]
    key = next(head for head in found if head.startswith("velocity_y"))
    assert float(found[key]) == pytest.approx(2 * force[1] / (8 * np.pi * 1.3e-6 * 499.3), rel=1e-2)


def test_it_stops_and_resumes_with_the_same_bits(call, whole):
    done = call("-c", STOP, code=1)
    assert "StoppedError" in done.stderr
    with h5py.File(call.folder / "stopped.h5") as file:
        assert file.attrs["status"] == b"stopped"
    rodsim(call, "resume", "stopped.h5", "--threads", "2")
    assert differences(call.folder / "stopped.h5", whole) == []


@pytest.mark.long
def test_the_commands_of_the_page_run_sweep_over_its_number_and_draw_its_flow(call):
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path}
    environment.pop("NUMBA_THREADING_LAYER", None)
    done = subprocess.run(["bash", "-euc", BLOCKS["sh"]], cwd=call.folder, env=environment,
                          capture_output=True, text=True)  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "trough_work" in done.stdout
    table = (call.folder / "sweep" / "summary.csv").read_text()
    assert table.count("finished") == 2
    assert "trough.stiffness" in table.splitlines()[0]
    assert (call.folder / "out_flow.png").stat().st_size > 10_000


def test_its_words_are_checked_and_in_the_schema(call):
    text = FILES["case.yaml"].replace("stiffness: 2.0e-4", "stiffness: -2")
    (call.folder / "bad.yaml").write_text(text)
    done = rodsim(call, "validate", "bad.yaml", code=2)
    assert done.stderr.startswith("bad.yaml:2: trough.stiffness = -2: must be > 0")
    assert '"Trough"' in rodsim(call, "schema").stdout


def test_without_it_the_word_is_unknown_and_the_file_says_so(call, whole):
    done = rodsim(call, "validate", "case.yaml", code=2, RODSIM_PARTS="")
    assert done.stderr.startswith("case.yaml:2: trough: unknown key")
    done = rodsim(call, "flow", str(whole), code=4, RODSIM_PARTS="")
    assert "trough" in done.stderr


def test_a_module_that_is_not_there_is_told(call):
    done = rodsim(call, "validate", "case.yaml", code=2, RODSIM_PARTS="trough, truogh")
    assert done.stderr == "RODSIM_PARTS: cannot import 'truogh': No module named 'truogh'\n"
    done = rodsim(call, "validate", "case.yaml", code=2, RODSIM_PARTS="json")
    assert done.stderr == "RODSIM_PARTS: 'json' has no KIND: see docs/own-parts.md\n"
