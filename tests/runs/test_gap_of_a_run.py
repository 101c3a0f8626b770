"""The gap in a run: stored, said once, in the last lines, the same after a resume."""

import shutil

import h5py
import numpy as np
import pytest
from calls import command
from contents import differences
from twins import gap

from rodsim import load_case, open_trajectory, resume, simulate
from rodsim.errors import StoppedError

CASE = """\
fluid: {viscosity: 1.3e-6, epsilon: 0.3}
rods:
  a:
    shape: {kind: straight, points: 31, length: 5}
    moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}
    strain_twist: [0.6, 0, 0]
  b:
    shape: {kind: straight, points: 31, length: 5, origin: [0.05, 0.5, 0]}
    moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}
    strain_twist: [-0.6, 0, 0]
time: {end: 0.02, tolerance: 1.0e-3}
output: {interval: 5.0e-4}
"""
THICK = 2 * np.exp(-0.5) * 0.3


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A run of two rods that bend into each other, a copy of it stopped, and what was said."""
    folder = tmp_path_factory.mktemp("gap")
    (folder / "case.yaml").write_text(CASE)
    said, copies = [], []

    def stop():
        copies.append(shutil.copy(folder / "out.h5", folder / f"{len(copies)}.h5"))
        return ""

    case = load_case(folder / "case.yaml")
    summary = simulate(case, folder / "out.h5", notify=said.append, stop=stop)
    return folder, said, copies, summary


def test_the_gap_of_every_frame_is_stored(whole):
    folder = whole[0]
    with open_trajectory(folder / "out.h5") as run:
        found = run.observable("gap")
        assert found.shape == (41,)
        assert run.observable("gap", -1) == found[-1]
        assert run.unit("gap") == "um"
        # pi/2 THICK is 3.4 spacings of 1/6
        expected = [gap(X, [31, 31], [False, False], [3, 3]) for X in run.position]
    np.testing.assert_allclose(found, expected, rtol=1e-15)
    with h5py.File(folder / "out.h5", locking=False) as file:
        assert file["observables/gap/time"] == file["particles/trajectory/position/time"]


def test_one_warning_with_rods_points_and_time(whole):
    folder, said, _, _ = whole
    with open_trajectory(folder / "out.h5") as run:
        gaps, first = run.observable("gap"), int(np.argmax(run.observable("gap") < THICK))
        X, t = run.position[first], run.time[first]
    assert 0 < first < 20
    assert gaps[0] > THICK
    assert len(said) == 1
    distance = np.linalg.norm(X[:31, None] - X[None, 31:], axis=2)
    i, j = np.unravel_index(distance.argmin(), distance.shape)
    assert f"rods 'a' and 'b' come closer than they are thick: points {i} and {j}" in said[0]
    assert f"are {gaps[first]:.3g} um apart at t = {t:.6g} s" in said[0]
    assert "is 0.364 um thick" in said[0]


def test_the_last_lines_and_info_say_how_small_it_got(whole):
    folder, _, _, summary = whole
    with open_trajectory(folder / "out.h5") as run:
        gaps = run.observable("gap")
        least = f"smallest gap {gaps.min():.3g} um at t = {run.time[gaps.argmin()]:.4g} s"
    lines = [f"{least}; the rods are 0.364 um thick", *summary.endings[1:]]
    assert summary.endings == lines
    assert lines[1].startswith("still moving: fastest point ")
    info = command("info", folder / "out.h5")
    assert all(line in info.stdout.splitlines() for line in lines)


def test_a_resume_ends_with_the_same_and_does_not_say_it_again(whole, tmp_path):
    folder, _, copies, summary = whole
    said = []
    for number in (0, len(copies) // 2, len(copies) - 2):
        copy = shutil.copy(copies[number], tmp_path)
        with open_trajectory(copy) as run:
            warned = (run.observable("gap")[: run.frames] < THICK).any()
        before = len(said)
        end = resume(copy, notify=said.append)
        assert len(said) - before == (not warned)
        assert end.endings == summary.endings
        assert differences(copy, folder / "out.h5") == []
    assert 0 < len(said) < 3  # both kinds were among them


def test_a_file_from_before_there_was_a_gap_is_read_and_goes_on(whole, tmp_path):
    folder, _, copies, _ = whole
    for overrides in ((), ["time.end=0.021"]):
        old = shutil.copy(copies[len(copies) // 2], tmp_path)
        with h5py.File(old, "r+", locking=False) as file:
            del file["observables/gap"]
            same = int(file["committed"][()]) if overrides else 41  # another end, other steps to it
        command("info", old, "--check")
        end = resume(old, overrides=overrides, notify=list)
        assert end.status == "finished"
        with open_trajectory(old) as run, open_trajectory(folder / "out.h5") as new:
            assert "gap" not in run.observables
            assert np.array_equal(run.position[:same], new.position[:same])


def test_rods_that_start_too_close_are_said_at_once(tmp_path):
    (tmp_path / "case.yaml").write_text(CASE.replace("[0.05, 0.5, 0]", "[0.05, 0.3, 0]"))
    case, said = load_case(tmp_path / "case.yaml", ["time.end=1e-3"]), []
    with pytest.raises(StoppedError):
        simulate(case, tmp_path / "out.h5", notify=said.append, stop=lambda: "the test")
    assert len(said) == 1
    assert "are 0.304 um apart at t = 0 s" in said[0]  # sqrt(0.05^2 + 0.3^2)


@pytest.mark.parametrize("name", ["validate", "run"])
def test_rods_in_one_place_are_refused(tmp_path, name):
    (tmp_path / "case.yaml").write_text(CASE.replace("[0.05, 0.5, 0]", "[0, 0, 0]"))
    done = command(name, tmp_path / "case.yaml", code=2)
    assert "case.yaml:4: rods.a.shape" in done.stderr
    assert "point 0 lies on point 0 of rod 'b'" in done.stderr


def test_what_has_no_two_points_that_count_has_no_gap(tmp_path):
    (tmp_path / "case.yaml").write_text(CASE)
    changes = ["rods.b=null", "rods.a.shape.points=4", "rods.a.shape.length=0.5", "time.end=1e-5"]
    summary = simulate(load_case(tmp_path / "case.yaml", changes), tmp_path / "out.h5")
    with open_trajectory(tmp_path / "out.h5") as run:
        assert "gap" not in run.observables
    assert len(summary.endings) == 1
