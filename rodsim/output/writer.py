"""Streams a run to its HDF5 file, frame by frame; nothing accumulates in memory."""

from __future__ import annotations

import os
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np

from rodsim.errors import FileError
from rodsim.output import layout
from rodsim.output.build import build_file, reserve
from rodsim.output.layout import CLOCK, TRACERS, TRAJECTORY
from rodsim.output.paths import OutputLock, free_name
from rodsim.output.vtkhdf import show_frame


class TrajectoryWriter:
    """The output file of one run, open for writing. Use as a context manager.

    ``committed`` is the number of frames that count: it is raised after the frame's data are
    flushed, so a reader, or whoever comes after a kill, never sees half a frame.
    """

    def __init__(self, path: Path, times: np.ndarray, lock: OutputLock, renamed_to: Path | None):
        self.path, self.times, self.renamed_to = path, times, renamed_to
        self.committed = 0
        self._lock = lock
        with self._writing():
            self._file = h5py.File(path, "r+", locking=False)

    @classmethod
    def create(
        cls, path, *, case, rods, times, tracers, fields, units, density, overwrite=False
    ) -> TrajectoryWriter:
        """Build the file whole under a temporary name, then give it its own.

        Parameters
        ----------
        case : CaseText; rods : list of RodRecord; times : (T,) of all frames to come;
        tracers : number P; fields : names out of ``layout.FIELDS``; units : names of the units of length, mass, time;
        density : True where kinetic energy is recorded.
        overwrite : replace an existing output, which is otherwise renamed (``renamed_to``).

        Raises
        ------
        FileError : no room, no permission, or another process is writing this file.
        """
        path = Path(path)
        if path.is_dir() or not path.parent.is_dir():
            raise FileError(f"{path}: is not a file in an existing folder")
        lock = OutputLock(path)
        lock.acquire()
        building = path.with_name(f".{path.name}.{os.getpid()}.tmp")
        try:
            build_file(building, case, rods, times, tracers, fields, units, density)
            reserve(building)
            renamed_to = None
            if path.exists() and not overwrite:
                renamed_to = free_name(path)
                path.rename(renamed_to)
            building.replace(path)
            return cls(path, times, lock, renamed_to)
        except BaseException as error:
            building.unlink(missing_ok=True)
            lock.release()
            if isinstance(error, OSError):
                raise FileError(f"{path}: cannot be written: {error.strerror or error}") from error
            raise

    def __enter__(self):
        return self

    def __exit__(self, *error):
        if self._file:
            self.finish("stopped", {})

    def write_frame(self, index: int, step: int, fields: dict, observables: dict) -> None:
        """Write frame ``index`` and commit it.

        fields : structure of arrays, (3, N), director (3, 3, N), ``tracers`` (3, P); those that
            the file does not store are left out. observables : (R,) or (3,) each.

        Raises
        ------
        ValueError : a value to be stored is not finite. FileError : the disk is full or gone.
        """
        file = self._file
        with self._writing():
            for name in file[TRAJECTORY]:
                _put(file[f"{TRAJECTORY}/{name}/value"], index, fields[name], points_first=True)
            if TRACERS in file:
                _put(file[f"{TRACERS}/value"], index, fields["tracers"], points_first=True)
            for name in file["observables"]:
                _put(file[f"observables/{name}/value"], index, observables[name])
            file[f"{CLOCK}/time"][index] = self.times[index]
            file[f"{CLOCK}/step"][index] = step
            file.flush()
            file["committed"][()] = index + 1
            show_frame(file, index, self.times[index])
            file.flush()
        self.committed = index + 1

    def finish(self, status: str, runtime: dict) -> None:
        """Set the status and ``/runtime``, close the file, give back the lock."""
        try:
            with self._writing():
                fixed = np.bytes_(status.ljust(layout.STATUS_BYTES, "\0"))
                self._file.attrs.modify("status", fixed)
                self._file["runtime"].attrs.update(runtime)
                self._file.close()
        finally:
            self._file = None
            self._lock.release()

    @contextmanager
    def _writing(self):
        try:
            yield
        except (OSError, RuntimeError) as error:
            raise FileError(
                f"{self.path}: writing failed: {error}. Its first {self.committed} frames are safe"
            ) from error


def _put(dataset, index, values, points_first=False):
    values = np.moveaxis(values, -1, 0) if points_first else values
    if not np.isfinite(values).all():
        raise ValueError(f"{dataset.name}: frame {index} is not finite")
    dataset[index] = values
