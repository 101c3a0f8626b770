"""Streams a run to its HDF5 file, frame by frame; nothing accumulates in memory."""

from __future__ import annotations

import os
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np

from rodsim.errors import FileError
from rodsim.files import reason_of
from rodsim.output import layout, rows
from rodsim.output.build import abandoned, build_file, trim
from rodsim.output.checkpoint import CheckpointWriter
from rodsim.output.layout import CLOCK, Plan
from rodsim.output.paths import OutputLock, check_place, take_place, temporary_name
from rodsim.output.rows import Rows
from rodsim.output.vtkhdf import View


class NotFinite(ValueError):
    """A value of a frame is NaN or infinite; ``name`` says which."""

    def __init__(self, name: str):
        super().__init__(f"{name}: not finite")
        self.name = name


class TrajectoryWriter:
    """The output file of one run, open for writing. A context manager.

    ``committed`` is the number of frames that count. It is raised when a frame's data have gone
    to the system, so a reader, or whoever comes after a kill, never sees half a frame.

    Attributes
    ----------
    path : the file. times : (T,) of all planned frames. renamed_to : where an older output with
    the same name has gone, or None.
    """

    def __init__(self, path: Path, file: h5py.File, plan: Plan, lock: OutputLock):
        self.path, self.times, self.renamed_to = path, plan.times, None
        self.committed = int(file["committed"][()])
        self._file, self._lock = file, lock
        self._fields, self._observables = [*plan.fields_stored()], [*plan.observables_stored()]
        self._values = [Rows(file, f"{s.where}/value") for s in plan.stored()]
        self._time, self._step = Rows(file, f"{CLOCK}/time"), Rows(file, f"{CLOCK}/step")
        self._counter, self._view = Rows(file, "committed"), View(file["VTKHDF"])
        self._checkpoint = CheckpointWriter(file["checkpoint"])

    @classmethod
    def create(cls, path, plan: Plan, overwrite=False, fill=None) -> TrajectoryWriter:
        """Build the file whole under a temporary name, then give it its own.

        overwrite : replace an output that exists; else it is renamed (see ``renamed_to``).
        fill : called with the writer before the file appears.

        Raises
        ------
        FileError : no room, no permission, or another process is writing this file. What was
            there before is then still there.
        """
        path = Path(path)
        check_place(path, overwrite)
        lock = OutputLock(path)
        lock.acquire()
        return cls.create_locked(path, plan, lock, overwrite, fill)

    @classmethod
    def create_locked(cls, path, plan, lock, overwrite, fill) -> TrajectoryWriter:
        """Do what ``create`` does with a lock that is held; it is given back on an error."""
        try:
            return cls._build(path, plan, lock, overwrite, fill)
        except (OSError, FileError) as error:
            lock.release()
            cause = error.__cause__ if isinstance(error.__cause__, OSError) else error
            raise FileError(f"{path}: cannot be written: {reason_of(cause)}") from error
        except BaseException:
            lock.release()
            raise

    @classmethod
    def _build(cls, path, plan, lock, overwrite, fill):
        building = temporary_name(lock.file)
        writer = cls(path, build_file(building, plan), plan, lock)
        try:
            writer.checkpoint(plan.checkpoint)
            if fill is not None:
                fill(writer)
            writer.sync()
            lock.cover(building)
            writer.renamed_to = take_place(building, lock.file, overwrite)
        except BaseException:
            if writer._file is not None:
                writer._file.close()
            building.unlink(missing_ok=True)
            raise
        return writer

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.finish("stopped", {})

    def write_frame(self, index: int, step: int, fields: dict, observables: dict) -> None:
        """Write frame ``index`` and commit it: the next one, or an earlier one again.

        fields : structure of arrays, (3, N), director (3, 3, N) as [i, component, point],
            tracers (3, P). observables : (R,), (3,) or () each. What the file does not store is
            left out.

        Raises
        ------
        ValueError : a value is missing, not finite, or has another shape; nothing is written.
        FileError : the disk is full or gone.
        """
        if not 0 <= index <= self.committed or index >= len(self.times):
            raise ValueError(f"frame {index}: have {self.committed} of {len(self.times)}")
        values = [_row(series, fields, -1) for series in self._fields]
        values += [_row(series, observables, 0) for series in self._observables]
        with self.writing() as file:
            for place, row in zip(self._values, values, strict=True):
                place.put(index, row)
            self._time.put(index, self.times[index])
            self._step.put(index, step)
            self._commit(file, index)

    def checkpoint(self, state: dict) -> None:
        """Store the state of the run: arrays and numbers by name, the same ones each time.

        Raises ValueError where names, shapes or types change, FileError where the disk is full.
        """
        with self.writing():
            self._checkpoint.write(state)

    def update_runtime(self, runtime: dict) -> None:
        """Set attributes of ``/runtime``: numbers and short texts by name."""
        with self.writing() as file:
            attrs = file["runtime"].attrs
            for name, value in runtime.items():
                if name in (*layout.MACHINE, *layout.DEVICE) and name not in attrs:
                    continue  # of an older rodsim, or on a CPU: nothing may be added
                attrs.modify(name, short(value) if isinstance(value, str) else value)
            file.flush()

    def sync(self) -> None:
        """Wait until all that was written is on the disk: then it outlives a power cut as well."""
        with self.writing() as file:
            file.flush()
            os.fsync(rows.descriptor(file))

    def finish(self, status: str, runtime: dict) -> None:
        """Set status and ``/runtime``, close the file, give back the lock. Once; then nothing."""
        if status not in layout.STATUS[1:]:
            raise ValueError(f"no such end of a run: {status}")
        try:
            if self._file is not None:
                self.update_runtime(runtime)
                with self.writing() as file:
                    file.attrs.modify("status", short(status))
                    self.sync()
                    trim(file)
                    file.close()
        finally:
            self._file = None
            self._lock.release()

    def _commit(self, file, index):
        """Let the frame count; its data are written. The flush keeps the order within the view."""
        committed = max(self.committed, index + 1)
        self._view.count(committed)
        file.flush()
        self._counter.put_all(committed)
        self.committed = committed
        self._view.show(index, self.times[index])

    @contextmanager
    def writing(self):
        """Yield the open file; an error in the block closes this writer, as a FileError."""
        if self._file is None:
            raise FileError(f"{self.path}: is closed, after an error in writing or at its end")
        gone = _gone(self._file)
        if gone:
            abandoned.append(self._file)
            self._file = None
            raise FileError(f"{self.path}: {gone} while the run was writing it; run the case again")
        try:
            yield self._file
        except (OSError, RuntimeError) as error:
            abandoned.append(self._file)
            self._file = None
            raise FileError(
                f"{self.path}: writing failed: {error}; its first {self.committed} frames are safe"
            ) from error


def _gone(file):
    """Return what someone else has done to the file: removed, replaced or cut it; or nothing."""
    found = os.fstat(rows.descriptor(file))
    if found.st_nlink == 0:
        return "was removed or replaced"
    return "was cut short" if found.st_size < file.id.get_filesize() else ""


def _row(series, given, point_axis):
    """Return what is stored of one quantity in a frame: points first, as readers want it."""
    if series.name not in given:
        raise ValueError(f"{series.name}: missing in a frame")
    row = np.asarray(given[series.name])
    if point_axis and row.ndim:
        row = row.transpose(point_axis, *range(row.ndim - 1))
    if row.shape != series.shape:
        raise ValueError(f"{series.name}: {row.shape} in a frame, not {series.shape}")
    if not np.isfinite(row).all():
        raise NotFinite(series.name)
    return row


def short(text: str):
    """Return a text cut to the fixed length of those that are changed in place."""
    return np.bytes_(text.encode()[: layout.TEXT_BYTES])
