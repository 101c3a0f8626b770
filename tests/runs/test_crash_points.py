"""The file after a crash at any point of its writing: every write replayed, whole and torn.

The writer runs on a file object that logs what HDF5 writes, and where, and so are the writes past
HDF5. The file is then rebuilt
write by write, as a crash would leave it, and each time everything that was acknowledged must be
there: the frames, the view of ParaView, a checkpoint.
"""

import os
from contextlib import contextmanager

import h5py
import numpy as np
import pytest
from outputs import TIMES, frame, make_plan

from rodsim import open_trajectory
from rodsim.errors import FileError
from rodsim.output import reopen, rows
from rodsim.output.layout import FIELDS
from rodsim.output.paths import OutputLock
from rodsim.output.writer import TrajectoryWriter


class Logged:
    """A file for h5py's file-object driver; logs (offset, bytes), a length, or a mark."""

    def __init__(self, path, mode, log):
        self.stream, self.log = open(path, mode, buffering=0), log  # noqa: SIM115

    def write(self, data):
        self.log.append((self.stream.tell(), bytes(data)))
        return self.stream.write(data)

    def truncate(self, size=None):
        size = self.stream.tell() if size is None else size
        # HDF5 makes a file as long as it needs it; the writer has reserved more
        if size > os.fstat(self.stream.fileno()).st_size:
            self.log.append(size)
            self.stream.truncate(size)
        return size

    def __getattr__(self, name):
        return getattr(self.stream, name)


@contextmanager
def logging(monkeypatch, log):
    """Let the writer write through logged files."""
    streams = []

    def opened(path, new):
        streams.append(Logged(path, "x+b" if new else "r+b", log))
        return h5py.File(streams[-1], "w" if new else "r+")

    def write_at(handle, data, offset, write=rows.write_at):
        log.append((offset, bytes(data)))
        write(handle, data, offset)

    with monkeypatch.context() as patch:
        patch.setattr(rows, "descriptor", lambda file: streams[-1].fileno())
        patch.setattr(rows, "write_at", write_at)
        patch.setattr(rows, "open_to_write", opened)
        patch.setattr(reopen, "open_to_write", opened)
        yield
    for stream in streams:
        stream.close()


def state(number):
    random = np.random.default_rng(1000 + number)
    return {"X": random.normal(size=(3, 9)), "step": number, "time": 0.3 * number}


def record(path, monkeypatch, times, restart):
    """Write a file with all kinds of frames; return its bytes at the beginning, and the log.

    Marks in the log: ("frame", n) and ("state", n) say what has been acknowledged before.
    """
    log, plan = [], make_plan(times=times, checkpoint=state(0))
    with logging(monkeypatch, log):
        writer = TrajectoryWriter.create(path, plan)
        start = path.read_bytes()
        log.clear()
        for index in range(len(times)):
            if index == restart:
                del writer._file  # as a process that is killed: nothing is closed
                writer._lock.release()
                lock = OutputLock(path)
                lock.acquire()
                writer = reopen.reopen(path, plan, lock)
                reopen.note_resume(writer, "once more")
                # the frame before is written again, as after a checkpoint that came before it
                writer.write_frame(index - 1, 10 * index - 8, *frame(index - 1))
            writer.write_frame(index, 10 * index + 2, *frame(index))
            log.append(("frame", index + 1))
            writer.checkpoint(state(index + 1))
            log.append(("state", index + 1))
            if index % 3 == 2:
                writer.update_runtime({"evaluations": 100 + index})
                writer.sync()
        writer.finish("finished", {"evaluations": 7})
    log.append(("frame", len(times)))
    return start, log


def crash_points(path, start, log):
    """Rebuild the file at every crash point; yield what was acknowledged, and what is written."""
    path.write_bytes(start)
    done = {"frame": 0, "state": 0}
    with open(path, "r+b", buffering=0) as file:
        for entry in log:
            if isinstance(entry, int):
                file.truncate(max(entry, os.fstat(file.fileno()).st_size))
            elif isinstance(entry[0], str):
                done[entry[0]] = entry[1]
            else:
                offset, data = entry
                for part in sorted({len(data) // 2, len(data)} - {0}):
                    os.pwrite(file.fileno(), data[:part], offset)
                    yield done


def assert_intact(path, done, expected):
    """Everything acknowledged is there, and nothing else is claimed."""
    with open_trajectory(path) as run:
        assert done["frame"] <= run.frames <= done["frame"] + 1
        np.testing.assert_array_equal(run.time, run.planned[: run.frames])
        for name in (*FIELDS, "tracers"):
            np.testing.assert_array_equal(run.read(name), expected[name][: run.frames])
        for name in run.observables:
            np.testing.assert_array_equal(run.observable(name), expected[name][: run.frames])
        found, number = run.checkpoint(), done["state"]
        assert found["step"] in (number, number + 1)
        np.testing.assert_array_equal(found["X"], state(found["step"])["X"])
        frames, planned = run.frames, run.planned
    with h5py.File(path, locking=False) as file:
        view = file["VTKHDF"]
        shown, values = int(view["Steps"].attrs["NSteps"]), view["Steps/Values"][:]
        # NSteps before the counter or after it, by one write; its times are never more than it
        assert abs(shown - frames) <= 1
        assert shown >= done["frame"]
        assert len(values) <= max(1, shown)
        np.testing.assert_array_equal(values[: done["frame"]], planned[: done["frame"]])
        points = view["Points"][: 9 * done["frame"]].reshape(-1, 9, 3)
        np.testing.assert_array_equal(points, expected["position"][: done["frame"]])


def all_frames(count):
    """Return every series of the first frames, as the reader gives it."""
    expected = {}
    for index in range(count):
        fields, observables = frame(index)
        rows = {name: np.moveaxis(value, -1, 0) for name, value in fields.items()} | observables
        rows["director"] = fields["director"].transpose(2, 0, 1)
        for name, row in rows.items():
            expected.setdefault(name, []).append(row)
    return {name: np.array(rows) for name, rows in expected.items()}


def replay(tmp_path, monkeypatch, times, restart, every=1):
    start, log = record(tmp_path / "out.h5", monkeypatch, times, restart)
    expected, points = all_frames(len(times)), 0
    for points, done in enumerate(crash_points(tmp_path / "crashed.h5", start, log), 1):
        if points % every == 0:
            assert_intact(tmp_path / "crashed.h5", done, expected)
    with open_trajectory(tmp_path / "crashed.h5") as run:
        assert run.frames == len(times)
        assert run.status == "finished"
        assert run.resumes == ["once more"]
    return points


def test_every_frame_survives_a_crash_at_every_write(tmp_path, monkeypatch):
    points = replay(tmp_path, monkeypatch, TIMES[:4], restart=2, every=5)
    assert points > 200


@pytest.mark.long
def test_every_frame_survives_a_crash_at_every_write_of_a_longer_run(tmp_path, monkeypatch):
    points = replay(tmp_path, monkeypatch, 0.3 * np.arange(90), restart=70)
    print(f"{points} crash points")
    assert points > 5000


def test_the_replay_sees_a_frame_that_is_claimed_too_early(tmp_path, monkeypatch):
    """The test of the test: a counter that is raised before the data is found out."""
    write, commit = TrajectoryWriter.write_frame, TrajectoryWriter._commit

    def early(writer, index, *rest):
        commit(writer, writer._file, index)
        write(writer, index, *rest)

    monkeypatch.setattr(TrajectoryWriter, "write_frame", early)
    with pytest.raises((AssertionError, FileError)):
        replay(tmp_path, monkeypatch, TIMES[:3], restart=2)
