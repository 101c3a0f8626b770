"""What is written is what is in the file: layout, order, counters, checkpoints, failures."""

import errno
import os
import shutil
import subprocess
import sys

import h5py
import numpy as np
import pytest
from outputs import CASE, POINTS, RODS, TIMES, TRACERS, UNITS, create, frame, write

from rodsim.compiled.settings import machine
from rodsim.errors import FileError
from rodsim.nodes import Rod, Rods
from rodsim.output import build, open_trajectory, rows
from rodsim.output.layout import FIELDS


def test_every_dataset_comes_back(tmp_path):
    with create(tmp_path / "out.h5") as writer:
        write(writer, range(4))
        writer.finish(
            "finished", {"wall_seconds": 2.5, "evaluations": 77, "threading_layer": "omp"}
        )
    with open_trajectory(tmp_path / "out.h5") as run:
        assert run.frames == 4
        np.testing.assert_array_equal(run.time, TIMES[:4])
        np.testing.assert_array_equal(run.steps, [2, 12, 22, 32])
        for index in range(4):
            fields, observables = frame(index)
            for name in set(FIELDS) - {"director"}:
                np.testing.assert_array_equal(run.read(name, index), fields[name].T)
            for i, component, point in np.ndindex(3, 3, POINTS):
                stored = run.director[index, point, i, component]
                assert stored == fields["director"][i, component, point]
            np.testing.assert_array_equal(run.tracers[index], fields["tracers"].T)
            for name, values in observables.items():
                np.testing.assert_array_equal(run.observable(name)[index], values)
        assert set(run.observables) == set(observables)
        assert run.rods == RODS
        assert (run.case_source, run.case_resolved) == (CASE.source, CASE.resolved)
        assert (run.overrides, run.resumes) == (CASE.overrides, [])
        assert (run.status, run.units) == ("finished", UNITS)
        given = {"wall_seconds": 2.5, "evaluations": 77, "threading_layer": "omp"}
        assert run.runtime == given | machine()


def test_layout_is_the_documented_one(tmp_path):
    with create(tmp_path / "out.h5") as writer:
        write(writer, range(2))
    with h5py.File(tmp_path / "out.h5") as file:
        trajectory, frames = file["particles/trajectory"], len(TIMES)
        assert trajectory["position/value"].shape == (frames, POINTS, 3)
        assert trajectory["director/value"].shape == (frames, POINTS, 3, 3)
        assert file["particles/tracers/position/value"].shape == (frames, TRACERS, 3)
        assert file["observables/power/value"].shape == (frames, 2)
        assert file["observables/net_torque/value"].shape == (frames, 3)
        assert file["committed"][()] == 2
        assert file.attrs["filetype"] == "rodsim"
        assert file.attrs["status"] == b"stopped"
        assert list(file["rods/alpha"].attrs["bending"]) == [2.5, 2.6]
        assert file["rods/alpha"].attrs["stretch"] == 0.4


def test_frames_to_come_are_nan_and_time_is_shared(tmp_path):
    with create(tmp_path / "out.h5") as writer:
        write(writer, range(2))
    with h5py.File(tmp_path / "out.h5") as file:
        clock, groups = file["particles/trajectory/position"], []
        file.visititems(lambda name, node: groups.append(node.parent) if "/value" in name else None)
        assert len(groups) == 6 + 1 + 9
        for group in groups:
            assert np.isfinite(group["value"][:2]).all()
            assert np.isnan(group["value"][2:]).all()
            assert group["time"] == clock["time"]  # the same object, not a copy
            assert group["step"] == clock["step"]
        assert np.isnan(clock["time"][2:]).all()
        assert (clock["step"][2:] == -1).all()


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("position", "um"),
        ("director", "1"),
        ("velocity", "um s^-1"),
        ("angular_velocity", "s^-1"),
        ("force", "g um s^-2"),
        ("torque", "g um^2 s^-2"),
        ("tracers", "um"),
        ("kinetic_energy", "g um^2 s^-2"),
        ("power", "g um^2 s^-3"),
        ("length", "um"),
        ("net_force", "g um s^-2"),
        ("net_torque", "g um^2 s^-2"),
    ],
)
def test_values_have_units(tmp_path, name, unit):
    create(tmp_path / "out.h5").finish("stopped", {})
    with open_trajectory(tmp_path / "out.h5") as run:
        assert run.unit(name) == unit


def test_what_is_not_asked_for_is_not_stored(tmp_path):
    options = {"fields": ("director",), "tracers": 0, "density": False}
    with create(tmp_path / "out.h5", **options) as writer:
        write(writer, range(1))
    with h5py.File(tmp_path / "out.h5") as file:
        assert set(file["particles/trajectory"]) == {"position", "director", "box"}
        assert "tracers" not in file["particles"]
        assert "kinetic_energy" not in file["observables"]


@pytest.mark.parametrize("name", ["position", "torque", "tracers", "shear_energy", "net_force"])
@pytest.mark.parametrize("bad", [np.nan, np.inf, "shape", "missing"])
def test_bad_frames_are_refused_before_anything_is_written(tmp_path, name, bad):
    with create(tmp_path / "out.h5") as writer:
        write(writer, range(1))
        for values in (parts := frame(1)):
            if name in values and bad == "missing":
                del values[name]
            elif name in values:
                values[name] = values[name][..., :1] if bad == "shape" else values[name] * bad
        with pytest.raises(ValueError, match=name):
            writer.write_frame(1, 5, *parts)
        with pytest.raises(ValueError, match="frame 2"):
            writer.write_frame(2, 5, *frame(2))
    with h5py.File(tmp_path / "out.h5") as file:
        assert file["committed"][()] == 1
        assert np.isnan(file["particles/trajectory/position/value"][1:]).all()


def test_an_earlier_frame_can_be_written_again(tmp_path):
    with create(tmp_path / "out.h5") as writer:
        write(writer, [0, 1, 2, 1])
        assert writer.committed == 3
        write(writer, [3])
    with open_trajectory(tmp_path / "out.h5") as run:
        np.testing.assert_array_equal(run.steps, [2, 12, 22, 32])


def state(number):
    random = np.random.default_rng(number)
    return {"X": random.normal(size=(3, POINTS)), "time": 0.1 * number, "step": 7 * number}


def assert_state(found, number):
    expected = state(number)
    assert found.keys() == expected.keys()
    for name, value in expected.items():
        np.testing.assert_array_equal(found[name], value)
        assert type(found[name]) is type(value)


def test_checkpoints_alternate_and_the_newest_whole_one_counts(tmp_path):
    first = {"checkpoint": state(0)}
    with create(tmp_path / "out.h5", **first) as writer, open_trajectory(writer.path) as run:
        assert_state(run.checkpoint(), 0)
        for number in range(1, 7):
            writer.checkpoint(state(number))
            with open_trajectory(tmp_path / "out.h5") as meanwhile:
                assert_state(meanwhile.checkpoint(), number)
    with h5py.File(tmp_path / "out.h5", "r+") as file:
        file["checkpoint/a/X"][1, 2] += 1e-12
    with open_trajectory(tmp_path / "out.h5") as run:
        assert_state(run.checkpoint(), 5)
    with h5py.File(tmp_path / "out.h5", "r+") as file:
        file["checkpoint/b/seal"][1] += 1
    with open_trajectory(tmp_path / "out.h5") as run:
        assert run.checkpoint() is None


@pytest.mark.parametrize("change", [{"X": np.zeros((3, 2))}, {"more": 5.5}, {"step": 2.5}])
def test_a_checkpoint_keeps_its_shape(tmp_path, change):
    with create(tmp_path / "out.h5") as writer:
        writer.checkpoint(state(3))
        with pytest.raises(ValueError, match="checkpoint"):
            writer.checkpoint(state(4) | change)
    with open_trajectory(tmp_path / "out.h5") as run:
        assert_state(run.checkpoint(), 3)


def test_runtime_can_be_updated_while_running(tmp_path):
    with create(tmp_path / "out.h5") as writer:
        writer.update_runtime({"evaluations": 5, "spectral_radius": 2.5})
        with open_trajectory(tmp_path / "out.h5") as run:
            assert (run.status, run.runtime) == (
                "running",
                {"evaluations": 5, "spectral_radius": 2.5} | machine(),
            )


def full(*_args, **_kwargs):
    raise OSError(errno.ENOSPC, "No space left on device")


@pytest.mark.parametrize("fails", ["usage", "posix_fallocate", "fsync"])
def test_a_full_disk_leaves_the_old_output(tmp_path, monkeypatch, fails):
    path = tmp_path / "out.h5"
    path.write_text("precious")
    if fails == "usage":
        monkeypatch.setattr(shutil, "disk_usage", lambda _: shutil._ntuple_diskusage(9, 8, 2500))
        message = r"out.h5: .* needs .* kB, 2.5 kB are free"
    else:
        monkeypatch.setattr(build.os, fails, full, raising=False)
        message = "out.h5: cannot be written: No space left on device"
    with pytest.raises(FileError, match=message):
        create(path)
    assert path.read_text() == "precious"
    assert [entry.name for entry in tmp_path.iterdir()] == ["out.h5"]


FULL = """
import resource, signal, sys
from outputs import create
from rodsim.compiled.settings import machine
from rodsim.errors import FileError
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # a write beyond the limit fails, as on a full disk
resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, 40_000))
try:
    create(sys.argv[1])
except FileError as error:
    print(error)
"""


@pytest.mark.skipif(not hasattr(os, "posix_fallocate"), reason="needs posix_fallocate")
def test_hdf5_never_meets_a_full_disk(tmp_path):
    path = tmp_path / "out.h5"
    path.write_text("precious")
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-c", FULL, str(path)]
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.endswith("out.h5: cannot be written: File too large\n")
    assert path.read_text() == "precious"
    assert os.listdir(tmp_path) == ["out.h5"]


@pytest.mark.parametrize(
    "rods", [RODS, Rods(Rod(f"rod{i}", 2 * i, 2, False, 0.5, (2.5,) * 6) for i in range(90))]
)
@pytest.mark.parametrize("frames", [1, 5000])
def test_what_is_reserved_is_enough(tmp_path, rods, frames):
    times = 0.3 * np.arange(frames)
    points = sum(rod.count for rod in rods)
    first = {"X": np.zeros((3, points)), "D": np.zeros((30, points))}
    with create(tmp_path / "out.h5", rods=rods, times=times, checkpoint=first) as writer:
        reserved = (tmp_path / "out.h5").stat().st_size
        writer.checkpoint(first)
        assert (tmp_path / "out.h5").stat().st_size == reserved
    assert (tmp_path / "out.h5").stat().st_size < reserved


def test_an_absurd_size_is_refused_at_once(tmp_path):
    rods = Rods([Rod("endless", 0, 10**15, False, 0.5, (2.5,) * 6)])
    with pytest.raises(FileError, match=r"needs [\d.e+]+ PB"):
        create(tmp_path / "out.h5", rods=rods)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("call", [(h5py.File, "flush"), (rows, "write_at")])
def test_a_write_that_fails_says_what_is_safe(tmp_path, monkeypatch, call):
    with create(tmp_path / "out.h5") as writer:
        write(writer, range(3))
        file = writer._file
        with monkeypatch.context() as broken:
            broken.setattr(*call, full)
            with pytest.raises(FileError, match=r"out.h5: .*No space.* first 3 frames are safe"):
                write(writer, [3])
        with pytest.raises(FileError, match="closed"):
            write(writer, [3])
    assert not (tmp_path / "out.h5.lock").exists()
    with open_trajectory(tmp_path / "out.h5") as run:
        assert run.frames == 3
    file.close()
