"""Streams a run to its HDF5 file, frame by frame; nothing accumulates in memory."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np

from rodsim.errors import FileError
from rodsim.output import layout
from rodsim.output.build import abandoned, build_file, trim
from rodsim.output.checkpoint import CheckpointWriter
from rodsim.output.layout import CLOCK, Plan
from rodsim.output.paths import OutputLock, take_place, temporary_name
from rodsim.output.rows import Rows
from rodsim.output.vtkhdf import count_frames, show_frame


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
        self.committed = 0
        self._file, self._plan, self._lock = file, plan, lock
        self._values = {s.where: Rows(file[f"{s.where}/value"]) for s in plan.stored()}
        self._time, self._step = Rows(file[f"{CLOCK}/time"]), Rows(file[f"{CLOCK}/step"])
        self._checkpoint = CheckpointWriter(file["checkpoint"])

    @classmethod
    def create(
        cls, path, *, case, rods, times, tracers, fields, units, density, overwrite=False
    ) -> TrajectoryWriter:
        """Build the file whole under a temporary name, then give it its own.

        Parameters
        ----------
        case : CaseText. rods : list of RodRecord. times : (T,) of all frames to come.
        tracers : number P. fields : names out of ``layout.FIELDS``; position is always stored.
        units : names of the units of ``length``, ``mass`` and ``time``.
        density : whether kinetic energy is stored.
        overwrite : replace an output that exists; else it is renamed (see ``renamed_to``).

        Raises
        ------
        FileError : no room, no permission, or another process is writing this file. What was
            there before is then still there.
        """
        path = Path(path)
        if not path.parent.is_dir():
            raise FileError(f"{path}: there is no folder {path.parent}")
        if path.exists() and not path.is_file():
            raise FileError(f"{path}: exists and is not a file")
        times = np.array(times, dtype=float)
        plan = Plan(case, list(rods), times, tracers, tuple(fields), dict(units), density)
        lock = OutputLock(path)
        lock.acquire()
        try:
            return cls._build(path, plan, lock, overwrite)
        except (OSError, FileError) as error:
            lock.release()
            reason = getattr(error, "strerror", None) or error
            raise FileError(f"{path}: cannot be written: {reason}") from error
        except BaseException:
            lock.release()
            raise

    @classmethod
    def _build(cls, path, plan, lock, overwrite):
        building = temporary_name(path)
        writer = cls(path, build_file(building, plan), plan, lock)
        try:
            writer.renamed_to = take_place(building, path, overwrite)
        except BaseException:
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
            tracers (3, P). observables : (R,) or (3,) each. What the file does not store is left
            out.

        Raises
        ------
        ValueError : a value is missing, not finite, or has another shape; nothing is written.
        FileError : the disk is full or gone.
        """
        if not 0 <= index <= self.committed or index >= len(self.times):
            raise ValueError(f"frame {index}: have {self.committed} of {len(self.times)}")
        rows = {s.where: _row(s, fields, -1) for s in self._plan.fields_stored()}
        rows |= {s.where: _row(s, observables, 0) for s in self._plan.observables_stored()}
        with self._writing() as file:
            for where, row in rows.items():
                self._values[where].write(index, row)
            self._time.write(index, self.times[index])
            self._step.write(index, step)
            file.flush()
            self._commit(file, index)

    def checkpoint(self, state: dict) -> None:
        """Store the state of the integrator: arrays and numbers by name, the same ones each time.

        Raises ValueError where names, shapes or types change, FileError where the disk is full.
        """
        with self._writing():
            self._checkpoint.write(state)

    def update_runtime(self, runtime: dict) -> None:
        """Set attributes of ``/runtime``: numbers and short texts by name."""
        with self._writing() as file:
            for name, value in runtime.items():
                value = _short(value) if isinstance(value, str) else value
                file["runtime"].attrs.modify(name, value)
            file.flush()

    def finish(self, status: str, runtime: dict) -> None:
        """Set status and ``/runtime``, close the file, give back the lock. Once; then nothing."""
        if status not in layout.STATUS[1:]:
            raise ValueError(f"no such end of a run: {status}")
        try:
            if self._file is not None:
                self.update_runtime(runtime)
                with self._writing() as file:
                    file.attrs.modify("status", _short(status))
                    trim(file)
                    file.close()
        finally:
            self._file = None
            self._lock.release()

    def _commit(self, file, index):
        """Let the frame count; its data are written. Each flush keeps the order on the disk."""
        committed = max(self.committed, index + 1)
        file["committed"][()] = committed
        count_frames(file["VTKHDF"], committed)
        file.flush()
        self.committed = committed
        show_frame(file["VTKHDF"], index, self.times[index])

    @contextmanager
    def _writing(self):
        if self._file is None:
            raise FileError(f"{self.path}: is closed, after an error in writing or at its end")
        try:
            yield self._file
        except (OSError, RuntimeError) as error:
            abandoned.append(self._file)
            self._file = None
            raise FileError(
                f"{self.path}: writing failed: {error}; its first {self.committed} frames are safe"
            ) from error


def _row(series, given, point_axis):
    """Return what is stored of one quantity in a frame: points first, as readers want it."""
    if series.name not in given:
        raise ValueError(f"{series.name}: missing in a frame")
    row = np.moveaxis(np.asarray(given[series.name]), point_axis, 0)
    if row.shape != series.shape:
        raise ValueError(f"{series.name}: {row.shape} in a frame, not {series.shape}")
    if not np.isfinite(row).all():
        raise ValueError(f"{series.name}: not finite")
    return row


def _short(text):
    """Return a text cut to the fixed length of those that are changed in place."""
    return np.bytes_(text.encode()[: layout.TEXT_BYTES])
