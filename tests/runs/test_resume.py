"""A run that goes on ends with the bits of one that was never interrupted."""

import os
import shutil
import signal
import subprocess
import sys
from contextlib import suppress

import h5py
import numpy as np
import pytest
from calls import call, command
from contents import differences
from interrupted import DRIVEN, PLANAR, after, make, run_with_copies

from rodsim import load_case, open_trajectory, resume, simulate
from rodsim.compiled.settings import machine
from rodsim.errors import CaseError, FileError, StoppedError

FIXED = ("output.interval=1e-5", "time.end=1e-4", "time.step=1e-6")
SCENES = {
    "driven rkc": (DRIVEN, ()),
    "planar rkc": (PLANAR, ()),
    "driven rk4": (DRIVEN, ("time.integrator=rk4", *FIXED)),
    "planar euler": (PLANAR, ("time.integrator=euler", *FIXED)),
}


def test_the_frames_of_a_run_are_read_once(tmp_path, monkeypatch):
    from rodsim.run import past

    looks, look = [], past.whole_frames
    monkeypatch.setattr(past, "whole_frames", lambda run: looks.append(run.path) or look(run))
    (tmp_path / "case.yaml").write_text(PLANAR)
    simulate(load_case(tmp_path / "case.yaml", ["time.end=1e-3"]), tmp_path / "out.h5")
    command("resume", tmp_path / "out.h5", "--set", "time.end=2e-3", "-q")
    with open_trajectory(tmp_path / "out.h5") as run:
        assert (run.status, run.time[-1]) == ("finished", 2e-3)
    assert len(looks) == 1


class Asked(Exception):
    """Stands for whatever ends a run between two steps."""


@pytest.fixture(params=SCENES, scope="module")
def unbroken(request, tmp_path_factory):
    """A run, and copies of its file after every step."""
    folder = tmp_path_factory.mktemp("unbroken")
    return run_with_copies(make(folder, *SCENES[request.param]), folder)[:2]


def test_a_run_killed_between_steps_goes_on_with_the_same_bits(unbroken, tmp_path):
    path, killed = unbroken
    assert len(killed) > 20
    for number in range(0, len(killed), len(killed) // 10):
        copy = shutil.copy(killed[number], tmp_path)
        with open_trajectory(copy) as run:
            assert run.status == "running"
        resume(copy)
        assert differences(copy, path) == []


def test_any_number_of_kills_and_any_number_of_threads(unbroken, tmp_path):
    path, killed = unbroken
    copy = tmp_path / "out.h5"
    shutil.copy(killed[0], copy)
    stops = 0
    while open_trajectory(copy).status != "finished":
        with suppress(StoppedError):
            resume(copy, stop=after(len(killed) // 7), threads=1 + stops % 2)
        stops += 1
    assert stops >= 7
    assert differences(copy, path) == []
    with open_trajectory(copy) as run:
        assert len(run.resumes) == stops
        assert "was running" in run.resumes[0]
        assert "was stopped" in run.resumes[-1]


def test_a_torn_checkpoint_leaves_the_other(unbroken, tmp_path):
    path, killed = unbroken
    copy = tmp_path / "out.h5"
    for slot in "ab":
        shutil.copy(killed[-4], copy)
        with h5py.File(copy, "r+", locking=False) as file:
            file[f"checkpoint/{slot}/position"][0, 3] += 1e-9
        resume(copy)
        assert differences(copy, path) == []
    with h5py.File(copy, "r+", locking=False) as file:
        file["checkpoint/a/time"][...] = file["checkpoint/b/time"][...] = 2.5e-3
        file.attrs.modify("status", np.bytes_("stopped"))
    with pytest.raises(FileError, match="neither of its checkpoints is whole"):
        resume(copy)


@pytest.mark.parametrize("broken", ["before the first step", "in the middle of a frame"])
def test_an_error_anywhere_leaves_a_file_that_goes_on(tmp_path, monkeypatch, broken):
    from rodsim.output import TrajectoryWriter

    case, path = make(tmp_path, PLANAR), tmp_path / "out.h5"
    frames = 0 if broken == "before the first step" else 5
    commit = TrajectoryWriter._commit

    def fail(writer, file, index):
        if index == frames:
            raise Asked
        commit(writer, file, index)

    simulate(case, tmp_path / "whole.h5")
    with monkeypatch.context() as patch:
        patch.setattr(TrajectoryWriter, "_commit", fail)
        with pytest.raises(Asked):
            simulate(case, path)
    with open_trajectory(path) as run:
        assert (run.frames, run.status) == (frames, "stopped")
    resume(path)
    assert differences(path, tmp_path / "whole.h5") == []


def test_a_rod_from_a_file_goes_on_without_it(tmp_path):
    case = make(tmp_path, DRIVEN)
    simulate(case, tmp_path / "first.h5")
    text = DRIVEN.replace(
        "kind: ring, radius: 0.4, points: 14,", "kind: file, path: first.h5, rod: ring,"
    )
    text = text.replace(", twist_perturbation: 0.7", "")
    case = make(tmp_path, text, ["time.end=2e-3"])
    simulate(case, tmp_path / "whole.h5")
    with pytest.raises(StoppedError):
        simulate(case, tmp_path / "out.h5", stop=after(9))
    (tmp_path / "first.h5").unlink()
    resume(tmp_path / "out.h5")
    assert differences(tmp_path / "out.h5", tmp_path / "whole.h5") == []


def test_a_later_end_keeps_what_is_there(tmp_path):
    case, path = make(tmp_path, DRIVEN, ["time.end=2.2e-3"]), tmp_path / "out.h5"
    simulate(case, path)
    with open_trajectory(path) as run:
        before, times = run.position, run.time
    resume(path, overrides=["time.end=4.1e-3"])
    with open_trajectory(path) as run:
        assert run.status == "finished"
        assert np.array_equal(run.position[: len(before)], before)
        new = [2.5e-3, 3e-3, 3.5e-3, 4e-3, 4.1e-3]
        np.testing.assert_allclose(run.time, [*times, *new], rtol=1e-15)
        assert '"end": 0.0041' in run.case_resolved
        assert run.overrides == ["time.end=2.2e-3", "time.end=4.1e-3"]
        assert "--set time.end=4.1e-3" in run.resumes[0]
        end, moved = run.position[-1], abs(run.position[-1] - before[-1]).max()
    simulate(make(tmp_path, DRIVEN, ["time.end=4.1e-3"]), tmp_path / "whole.h5")
    with open_trajectory(tmp_path / "whole.h5") as run:
        # not the same steps; 1e-5 is the tolerance of one step relative to a rod 2.5 long
        assert abs(run.position[-1] - end).max() < 1e-4 < moved / 20
    assert sorted(os.listdir(tmp_path)) == ["case.yaml", "out.h5", "whole.h5"]


def test_a_longer_run_can_be_killed_and_go_on(tmp_path):
    case, path = make(tmp_path, DRIVEN, ["time.end=2.2e-3"]), tmp_path / "out.h5"
    simulate(case, path)
    shutil.copy(path, tmp_path / "other.h5")
    later = ["time.end=4.1e-3"]
    resume(path, overrides=later)
    with pytest.raises(StoppedError):
        resume(tmp_path / "other.h5", overrides=later, stop=after(7))
    resume(tmp_path / "other.h5")
    assert differences(tmp_path / "other.h5", path) == []


def test_fields_that_are_added_are_there_for_all_frames(tmp_path):
    more = ["output.fields=[position, director, velocity, torque, force, angular_velocity]"]
    simulate(make(tmp_path, DRIVEN, more), tmp_path / "whole.h5")
    with pytest.raises(StoppedError):
        simulate(make(tmp_path, DRIVEN), tmp_path / "out.h5", stop=after(60))
    resume(tmp_path / "out.h5", overrides=more)
    # The motion of earlier frames is not in the file: it is evaluated, where a run has the
    # derivative of its dense output; docs/method.md has their difference, 0.4 % seen here.
    name = "particles/trajectory/angular_velocity/value"
    found = differences(tmp_path / "out.h5", tmp_path / "whole.h5")
    assert sorted(found) == ["VTKHDF/PointData/angular_velocity", name]
    with h5py.File(tmp_path / "out.h5") as added, h5py.File(tmp_path / "whole.h5") as whole:
        largest = abs(whole[name][:]).max(axis=(1, 2))
        gap = abs(added[name][:] - whole[name][:]).max(axis=(1, 2)) / largest
    assert 0 < np.count_nonzero(gap) < 6
    assert gap.max() < 0.01


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            "fluid.viscosity=2e-6",
            "fluid.viscosity = 2e-06: is 1.3e-06 in .*out.h5: a run that goes on",
        ),
        ("time.end=1e-3", "time.end = 0.001: is 0.002 in "),
        ("time.tolerance=1e-6", "time.tolerance = 1e-06: is 1e-05 in "),
        ("output.fields=[position]", "output.fields = .*: is .* in "),
        ("output.interval=1e-5", "output.interval = 1e-05: is 0.0005 in "),
        ("plane=yz", "Omega_3 must be the number 0"),
        ("time.edn=3", "did you mean 'end'"),
    ],
)
def test_other_changes_are_refused_with_the_difference(tmp_path, change, words):
    path = tmp_path / "out.h5"
    with pytest.raises(StoppedError):
        simulate(make(tmp_path, DRIVEN, ["time.end=2e-3"]), path, stop=after(5))
    before = path.read_bytes()
    with pytest.raises(CaseError, match=words):
        resume(path, overrides=[change])
    assert path.read_bytes() == before
    assert sorted(os.listdir(tmp_path)) == ["case.yaml", "out.h5"]


def test_what_cannot_be_computed_for_earlier_frames_is_refused(tmp_path):
    path = tmp_path / "out.h5"
    with pytest.raises(StoppedError):
        simulate(make(tmp_path, PLANAR), path, stop=after(5))
    with pytest.raises(CaseError, match="have no director, so force cannot be computed"):
        resume(path, overrides=["output.fields=[position, force]"])


def test_the_command_goes_on_and_says_so(tmp_path):
    path = tmp_path / "out.h5"
    simulate(make(tmp_path, PLANAR), tmp_path / "whole.h5")
    with pytest.raises(StoppedError):
        simulate(make(tmp_path, PLANAR), path, stop=after(5))
    done = call("resume", path)
    assert (done.exit_code, done.stdout) == (0, "")
    assert "finished: 17 frames" in done.stderr
    assert differences(path, tmp_path / "whole.h5") == []
    again = call("resume", path)
    assert again.exit_code == 0
    assert "is finished" in again.stderr
    refused = call("resume", path, "--set", "fluid.viscosity=3e-6")
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert "--set: fluid.viscosity = 3e-06: is 1.3e-06 in" in refused.stderr
    for wrong in (tmp_path / "none.h5", tmp_path / "case.yaml"):
        assert call("resume", wrong).exit_code == 4
    assert sorted(os.listdir(tmp_path)) == ["case.yaml", "out.h5", "whole.h5"]


@pytest.mark.parametrize("name", ["SIGTERM", "SIGINT", "SIGUSR1", "SIGHUP"])
def test_a_signal_stops_after_the_step(tmp_path, name):
    """The signal comes in the middle of a run of a process of its own, sent by itself."""
    simulate(make(tmp_path, DRIVEN), tmp_path / "whole.h5")
    code = (
        "import os, signal, sys; from rodsim.compiled.settings import prepare; prepare()\n"
        "from rodsim.run.watch import Watch; from rodsim.__main__ import main\n"
        "check = Watch.check\n"
        "def send(self, step):\n"
        f"    if step.number == 20: os.kill(os.getpid(), signal.{name})\n"
        "    return check(self, step)\n"
        "Watch.check = send; main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, "run", "case.yaml"],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (75, "")
    assert f"stopped by {name} at t = " in done.stderr
    assert "go on with: rodsim resume out.h5" in done.stderr
    with h5py.File(tmp_path / "out.h5") as file:
        assert file["runtime"].attrs["steps_accepted"] == 20
    resume(tmp_path / "out.h5")
    assert differences(tmp_path / "out.h5", tmp_path / "whole.h5") == []


def test_the_wall_time_stops_a_run(tmp_path):
    make(tmp_path, PLANAR)
    run = call("run", tmp_path / "case.yaml", "-o", tmp_path / "out.h5", "--max-wall", "1e-3s")
    assert run.exit_code == 2  # no such way to write a number of seconds
    assert "is not a duration such as 3h50m" in run.stderr
    run = call("run", tmp_path / "case.yaml", "-o", tmp_path / "out.h5", "--max-wall", "0.001s")
    assert run.exit_code == 75
    assert "stopped by the wall time given by --max-wall at t =" in run.stderr
    with open_trajectory(tmp_path / "out.h5") as trajectory:
        assert (trajectory.status, trajectory.frames) == ("stopped", 1)


def test_a_second_interrupt_does_not_wait(monkeypatch):
    from rodsim.run.stopping import Stopper

    with Stopper() as stop:
        os.kill(os.getpid(), signal.SIGINT)
        assert stop() == "SIGINT"
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)


STORED = {"numba": b"0.1", "processor": b"z80 00000000"}


@pytest.mark.parametrize("changed", [{}, *({name: text} for name, text in STORED.items()), STORED])
def test_another_machine_or_other_versions_are_warned_of_once(tmp_path, changed):
    path, said = tmp_path / "out.h5", []
    with suppress(StoppedError):
        simulate(make(tmp_path, PLANAR), path, stop=after(4))
    with h5py.File(path, "r+") as file:
        for name, text in changed.items():
            file["runtime"].attrs.modify(name, np.bytes_(text))
    with suppress(StoppedError):
        resume(path, stop=after(3), notify=said.append)
    resume(path, notify=said.append)
    here = machine()
    was = ", ".join(f"{name} {text.decode()}" for name, text in changed.items())
    now = ", ".join(f"{name} {here[name]}" for name in changed)
    warning = f"{path} was written with {was}, this is {now}: last digits can differ from those"
    assert said == ([f"{warning} of one run"] if changed else [])


def test_a_file_that_does_not_name_its_machine_goes_on(tmp_path):
    simulate(make(tmp_path, PLANAR), tmp_path / "whole.h5")
    path = tmp_path / "out.h5"
    with suppress(StoppedError):
        simulate(make(tmp_path, PLANAR), path, stop=after(4))
    with h5py.File(path, "r+") as file:
        for name in machine():
            del file["runtime"].attrs[name]
    resume(path)
    assert differences(path, tmp_path / "whole.h5") == []


@pytest.mark.skipif(shutil.which("h5repack") is None, reason="needs h5repack")
@pytest.mark.parametrize("layout", ["CONTI", "COMPA"])
def test_a_file_that_was_repacked_says_how_it_goes_on(tmp_path, layout):
    path, packed = tmp_path / "out.h5", tmp_path / "packed.h5"
    with suppress(StoppedError):
        simulate(make(tmp_path, PLANAR), path, stop=after(4))
    subprocess.run(["h5repack", "-l", layout, path, packed], check=True)
    with pytest.raises(FileError, match=r"laid out anew .* a later --set time.end="):
        resume(packed)
    assert resume(packed, overrides=["time.end=1.2e-2"]).status == "finished"


def test_nohup_stays_deaf_to_the_end_of_its_terminal(monkeypatch):
    from rodsim.run.stopping import signals

    assert signal.SIGHUP in signals()
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        assert signal.SIGHUP not in signals()
    finally:
        signal.signal(signal.SIGHUP, before)


# What a run goes on from -------------------------------------------------------------------------


def spoil(path, frame, where="particles/trajectory/position/value"):
    """Damage a committed frame, as a second writer or a power cut does."""
    with h5py.File(path, "r+") as file:
        file[where][frame, 3, 1] = np.nan


@pytest.fixture
def stopped(tmp_path):
    """An output that was stopped after some frames, and that of a whole run."""
    case = make(tmp_path, PLANAR)
    simulate(case, tmp_path / "whole.h5")
    path = tmp_path / "out.h5"
    with suppress(StoppedError):
        simulate(case, path, stop=lambda: "enough" if open_trajectory(path).frames > 7 else "")
    return path


def test_frames_after_a_checkpoint_are_mended(stopped):
    """The newest checkpoint builds on the frame that is damaged; the one before does not."""
    with open_trajectory(stopped) as run:
        last = run.frames - 1
        assert run.checkpoint()["frames"] == last + 1
        assert run.checkpoint(last)["frames"] <= last
    spoil(stopped, last)
    with pytest.warns(UserWarning, match=f"frame {last} is damaged; all from frame .* again"):
        resume(stopped)
    assert differences(stopped, stopped.parent / "whole.h5") == []


def test_a_frame_that_no_checkpoint_comes_before_is_refused(stopped):
    spoil(stopped, 2)
    refused = call("resume", stopped)
    assert refused.exit_code == 4
    assert f"{stopped}: damaged: frame 2 is not whole" in refused.stderr


def test_a_finished_run_with_a_damaged_frame_is_not_finished(stopped):
    path = stopped.parent / "whole.h5"
    assert "is finished" in call("resume", path).stderr
    spoil(path, 4)
    refused = call("resume", path)
    assert refused.exit_code == 4
    assert "frame 4 is not whole" in refused.stderr


def test_resume_goes_through_a_link_and_leaves_it(stopped):
    (stopped.parent / "sub").mkdir()
    link = stopped.parent / "sub" / "link.h5"
    link.symlink_to("../out.h5")
    resume(link, overrides=["time.end=1.2e-2"])
    assert link.is_symlink()
    assert not stopped.is_symlink()
    with open_trajectory(stopped) as run:
        assert (run.status, run.time[-1]) == ("finished", 1.2e-2)
    assert os.listdir(stopped.parent / "sub") == ["link.h5"]
