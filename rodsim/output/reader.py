"""Reads an output file, also of a run that goes on or was killed."""

from __future__ import annotations

import json
import os
from operator import index
from typing import Any, Self

import numpy as np

from rodsim.errors import FileError
from rodsim.nodes import Rods
from rodsim.output import layout
from rodsim.output.bodies import OfBodies
from rodsim.output.checkpoint import read_checkpoint
from rodsim.output.guarded import GuardedFile
from rodsim.output.header import header_of, rods_of
from rodsim.output.layout import CLOCK, OBSERVABLES, TRACERS, TRAJECTORY


def open_trajectory(path: str | os.PathLike[str]) -> Trajectory:
    """Open an output file for reading; raises FileError, in one line, if it cannot be trusted.

    >>> with open_trajectory("out.h5") as run:
    ...     run.time, run.position, run.observable("bending_energy")
    """
    return Trajectory(path)


class Trajectory(OfBodies):
    """The frames of an output file that were committed when it was opened. A context manager.

    T frames, N points of all rods one after another, P tracers. Values are in the case's units.

    Attributes
    ----------
    frames : T. points : N. time, steps : (T,), of each frame.
    rods : :class:`rodsim.nodes.Rods`, in order.
    planned : times of all frames the run is to have.
    status : running, finished, stopped or diverged. version, created, format : of the file.
    case_source, case_resolved : text. overrides, resumes : lists of text.
    inputs : digests of the files the case named, as JSON text, "" where it named none.
    wall : height of a plane wall, or None.
    units : names of the units of ``length``, ``mass``, ``time``. runtime : what the run has cost.
    """

    frames: int
    points: int
    time: np.ndarray
    steps: np.ndarray
    planned: np.ndarray
    rods: Rods
    format: int
    status: str
    version: str
    created: str
    case_source: str
    case_resolved: str
    inputs: str
    overrides: list[str]
    resumes: list[str]
    units: dict[str, str]
    runtime: dict[str, Any]

    def __init__(self, path: str | os.PathLike[str]):
        self.path = path
        self._file = GuardedFile(path)
        try:
            vars(self).update(header_of(self._file, path))
            self._read_frames()
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; what was read stays."""
        self._file.close()

    def read(self, name: str, frames=slice(None)) -> np.ndarray:
        """Return a field in some frames, or one: (T, N, 3), director (T, N, 3, 3), or less T.

        ``name`` is one of ``fields``; ``frames`` a slice or a number, negative from the end.
        Raises FileError if the field is not stored, IndexError for a frame that does not exist.
        """
        if name not in self.fields:
            raise FileError(
                f"{self.path}: has no {name}; it has {', '.join(self.fields)} "
                "(output.fields in the case says what is stored)"
            )
        if name == "tracers":
            return self._values(TRACERS, (None, 3), frames)
        shape = (self.points, 3, 3) if name == "director" else (self.points, 3)
        return self._values(f"{TRAJECTORY}/{name}", shape, frames)

    def observable(self, name: str, frames=slice(None)) -> np.ndarray:
        """Return one of ``observables``: (T, R) of each rod; of all, (T,) or for vectors (T, 3)."""
        if name not in self.observables:
            raise FileError(f"{self.path}: has no {name}; it has {', '.join(self.observables)}")
        shape = {name: (len(self.rods),) for name in layout.PER_ROD}
        shape |= dict.fromkeys(layout.BALANCES, (3,))
        return self._values(f"{OBSERVABLES}/{name}", shape.get(name), frames)

    def stores(self, where: str) -> bool:
        """Tell whether the file has a series at a place such as ``observables/power``."""
        group, _, name = where.rpartition("/")
        above, _, last = group.rpartition("/")
        return last in self._file.names(above or "/") and name in self._file.names(group)

    def values(self, series: layout.Series, frames=slice(None)) -> np.ndarray:
        """Return a series by its record, wherever in the file it is."""
        return self._values(series.where, series.shape, frames)

    def arrays(self, rod: str) -> dict[str, np.ndarray]:
        """Return what a rod's strain twist was made from beside the case's text, by name."""
        where = f"rods/{rod}"
        names = self._file.names(where)
        return {name: self._file.array(f"{where}/{name}", "f", None) for name in names}

    @property
    def fields(self) -> list[str]:
        """Names of the stored fields, with ``tracers`` where there are some."""
        stored = self._file.names(TRAJECTORY)
        known = [name for name in layout.FIELDS if name in stored]
        return known + ["tracers"] * ("position" in self._file.names("particles/tracers"))

    @property
    def observables(self) -> list[str]:
        """Names of the stored observables."""
        stored = self._file.names(OBSERVABLES)
        known = (*layout.PER_ROD, *layout.BALANCES)
        return [n for n in known if n in stored] + [n for n in stored if n not in known]

    @property
    def position(self) -> np.ndarray:
        """Positions in all frames, (T, N, 3)."""
        return self.read("position")

    @property
    def director(self) -> np.ndarray:
        """Triads in all frames, (T, N, 3, 3): [t, point, i, :] is D^(i+1)."""
        return self.read("director")

    @property
    def tracers(self) -> np.ndarray:
        """Positions of the tracers in all frames, (T, P, 3); P is 0 where there are none."""
        return self.read("tracers") if "tracers" in self.fields else np.empty((self.frames, 0, 3))

    @property
    def wall(self) -> float | None:
        """Height z of the plane wall, or None where there is none."""
        try:
            wall = json.loads(self.case_resolved)["fluid"].get("wall")
            return None if wall is None else float(wall["z"])
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            return None  # damaged: what needs the case says so

    def unit(self, name: str) -> str:
        """Return the unit of a field or observable, e.g. ``g um^2 s^-2``."""
        group = OBSERVABLES if name in self.observables else TRAJECTORY
        where = TRACERS if name == "tracers" else f"{group}/{name}"
        return self._file.attribute(f"{where}/value", "units", str)

    def labels(self, name: str) -> list[str]:
        """Return whose each row of an observable is: rods, bodies, ends such as ``tail.start``.

        Empty where it has no rows, such as a vector of the whole scene.
        """
        if name in layout.PER_ROD:
            return [rod.name for rod in self.rods]
        where = f"{OBSERVABLES}/{name}/value"
        rows = self._file.attributes(where).get("rows", "") if name in self.observables else ""
        return rows.split(", ") if rows else []

    def checkpoint(self, frames: int | None = None) -> dict | None:
        """Return the newest whole state of the run, or None if there is none.

        ``frames``: one that builds on no more frames than these.
        """
        return read_checkpoint(self._file, self.frames if frames is None else frames)

    def case_data(self) -> dict:
        """Return the resolved case as plain data; raises FileError where that cannot be read."""
        try:
            data = json.loads(self.case_resolved)
        except (ValueError, RecursionError) as error:
            raise self._file.damaged(f"its case cannot be read ({error})") from error
        if not isinstance(data, dict):
            raise self._file.damaged("its case cannot be read (it has no keys)")
        return data

    def _read_frames(self):
        self.frames = int(self._file.array("committed", "i", ()))
        self.rods = rods_of(self._file)
        self.points = self.rods.points
        self.time = self._rows(f"{CLOCK}/time", "f", ())
        self.steps = self._rows(f"{CLOCK}/step", "i", ())
        self.planned = self._file.array("case/times", "f", (None,), at_least=self.frames)
        if self.frames < 0 or not np.isfinite(self.time).all():
            raise self._file.damaged("frames without a time")

    def _values(self, where, shape, frames=slice(None)):
        return self._rows(f"{where}/value", "f", shape, frames)

    def _rows(self, name, kinds, shape, frames=slice(None)):
        """Return rows of a dataset, none beyond the committed frames."""
        if not isinstance(frames, slice):
            number = range(self.frames)[index(frames)]
            return self._rows(name, kinds, shape, slice(number, number + 1))[0]
        chosen = range(self.frames)[frames]
        forward = chosen if chosen.step > 0 else chosen[::-1]
        rows = np.s_[forward.start : forward.stop : forward.step]
        whole = None if shape is None else (None, *shape)
        values = self._file.array(name, kinds, whole, rows, at_least=self.frames)
        return values if chosen.step > 0 else values[::-1]
