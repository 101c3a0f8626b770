"""What info tells of an output beside its case: how it ended, what is in it, what it cost."""

import json
import os
import shutil

import h5py
import numpy as np
import pytest
from outputs import CASE, TIMES, create, frame, write

from rodsim.commands.stored_run import check_output, describe_output
from rodsim.errors import FileError
from rodsim.output import CaseText

ROD = {"moduli": {"bending": 0.3, "twisting": 0.2, "shear": 0.7, "stretch": 0.9}}
DATA = {
    "title": "",
    "fluid": {"viscosity": 2.7e-3, "blob": "algebraic7", "epsilon": 0.3},
    "rods": {"zeta": ROD, "alpha": ROD},
    "time": {"end": 1.7, "integrator": "rkc", "tolerance": 1e-5},
}
GAPS = np.array([0.9, 0.41, 0.7, 0.6])


@pytest.fixture
def path(tmp_path):
    return tmp_path / "out.h5"


def made(path, status, frames=4, data=DATA, extra=(), labels=None, runtime=None):
    """Make an output of some frames, which has ended so."""
    text = CaseText("", json.dumps(data), ["time.end=1.7"])
    plan = {"case": text, "extra": tuple((name, np.shape(v[0]), unit) for name, unit, v in extra)}
    with create(path, **plan, labels=labels or {}) as writer:
        for index in range(frames):
            fields, found = frame(index)
            found |= {name: values[index] for name, _, values in extra}
            writer.write_frame(index, 10 * index + 2, fields, found)
        writer.finish(status, runtime or {})


def lines_of(path):
    return describe_output(path).splitlines()


@pytest.mark.parametrize(
    ("status", "said"),
    [
        ("stopped", "stopped; go on with: rodsim resume {}"),
        ("finished", "finished"),
        ("diverged", "diverged"),
    ],
)
def test_how_a_run_has_ended_and_what_to_do(path, status, said):
    made(path, status)
    first, second, *_ = lines_of(path)
    assert first == f"{path}: {said.format(path)}"
    assert second == "4 of 6 frames, t = 0 to 0.9 s"


def test_a_run_that_goes_on_has_its_process_and_one_that_was_killed_none(path, tmp_path):
    killed = tmp_path / "killed.h5"
    with create(path) as writer:
        write(writer, range(2))
        shutil.copy(path, killed)
        first, second, *_ = lines_of(path)
    assert first.startswith(f"{path}: running, process {os.getpid()} on ")
    assert second == "2 of 6 frames, t = 0 to 0.3 s"
    assert lines_of(killed)[0] == f"{killed}: killed; go on with: rodsim resume {killed}"


def test_without_frames_nothing_is_told_of_motion(path):
    made(path, "stopped", frames=0)
    lines = lines_of(path)
    assert lines[1] == "0 of 6 frames, no time"
    assert not [line for line in lines if "moving" in line or "gap" in line]


def test_the_smallest_gap_and_when_it_was(path):
    """algebraic7: 1.213 epsilon, 0.3."""
    made(path, "finished", extra=[("gap", (0, 1, 0), GAPS)])
    assert "smallest gap 0.41 um at t = 0.3 s; the rods are 0.364 um thick" in lines_of(path)


@pytest.mark.parametrize(
    ("status", "frames", "said"),
    [("finished", 6, "still moving: "), ("finished", 4, "nothing moves any more: "),
     ("stopped", 4, "still moving: ")],
)  # fmt: skip
def test_rest_is_told_where_a_run_has_ended_before_its_time(path, status, frames, said):
    made(path, status, frames)
    assert [line.startswith(said) for line in lines_of(path) if "fastest point" in line] == [True]


def test_the_error_of_fast_sums_is_the_largest_of_all_frames(path):
    errors = np.array([[1e-6, 3e-5], [7e-6, 2e-5], [5e-6, 1e-5], [4e-6, 2e-5]])
    fast = {**DATA, "fluid": {**DATA["fluid"], "sums": {"accuracy": 2.5e-5}}}
    made(path, "finished", data=fast, extra=[("sum_error", (0, 0, 0), errors)])
    said = "fast sums: error of u up to 7e-06, of w 3e-05; 2.5e-05 asked: not reached"
    assert said in lines_of(path)


def test_whose_rows_are_told_where_they_are_not_those_of_rods(path):
    extra = [("anchor_force", (1, 1, -2), np.full((4, 2, 3), 0.3))]
    made(path, "finished", extra=extra, labels={"anchor_force": ["zeta.start", "alpha.end"]})
    lines = lines_of(path)
    assert "anchor_force of zeta.start, alpha.end" in lines
    assert not [line for line in lines if line.startswith("length of")]


def test_fields_costs_and_changes_are_told(path):
    made(path, "finished", runtime={"threads": 3, "wall_seconds": 1.23456789, "layer": "tbb"})
    lines = lines_of(path)
    assert {"threads: 3", "wall_seconds: 1.23457", "layer: tbb"} <= set(lines)
    assert lines[-1] == "--set time.end=1.7"
    (fields,) = (line for line in lines if line.startswith("fields: "))
    assert {"position", "director", "velocity"} <= set(fields[8:].split(", "))


def test_a_damaged_case_leaves_the_rest(path):
    with create(path, case=CASE) as writer:
        write(writer, range(len(TIMES)))
        writer.finish("finished", {})
    lines = lines_of(path)
    assert "rod alpha: 5 points, closed, spacing 0.5 um" in lines
    assert not [line for line in lines if "fastest point" in line]


def test_the_check_says_what_is_not_whole(path):
    made(path, "finished")
    with h5py.File(path, "r+") as file:
        file["particles/trajectory/position/value"][2, 3, 1] = np.nan
    with pytest.raises(FileError, match=r"out.h5: damaged: position in frame 2 is damaged"):
        check_output(path)
