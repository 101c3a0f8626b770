"""A stored run as Python sees it: its rods by name, its quantities, its arrays read once."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from rodsim.analysis.labelled import title_of, to_dataframe, to_xarray
from rodsim.analysis.measuring import measure
from rodsim.analysis.strain import strain_twist
from rodsim.case.words import did_you_mean
from rodsim.errors import UnknownName
from rodsim.nodes import Rod
from rodsim.output import reader
from rodsim.text import printable

if TYPE_CHECKING:
    import pandas
    import xarray


def open_trajectory(path: str | os.PathLike[str]) -> Trajectory:
    """Open an output file for reading; raises FileError, in one line, if it cannot be trusted.

    >>> with open_trajectory("out.h5") as run:
    ...     run.time, run.position, run["tail"].position, run.measure("writhe")
    """
    return Trajectory(path)


class Trajectory(reader.Trajectory):
    """The frames of an output file that were committed when it was opened. A context manager.

    T frames, N points of all R rods one after another, P tracers. Values are in the case's units.
    An array is read when it is first asked for, and kept; it cannot be written to, a ``copy()``
    can. After ``close()`` what was read stays, and what was not raises UsageError.

    ``run["tail"]`` is one rod, a :class:`RodTrajectory`; iterating gives the names of all.
    """

    def __init__(self, path: str | os.PathLike[str]):
        self._kept: dict[tuple[str, str], np.ndarray] = {}
        super().__init__(path)

    def read(self, name: str, frames=slice(None)) -> np.ndarray:
        """Return a field in some frames, or one: (T, N, 3), director (T, N, 3, 3), or less T.

        ``name`` is one of ``fields``; ``frames`` a slice or a number, negative from the end. All
        frames at once are kept. Raises FileError if the field is not stored, IndexError for a frame
        that does not exist.
        """
        return self._keep(("field", name), super().read, name, frames)

    def observable(self, name: str, frames=slice(None)) -> np.ndarray:
        """Return one of ``observables``: (T, R) of each rod; of all, (T,) or for vectors (T, 3)."""
        return self._keep(("observable", name), super().observable, name, frames)

    def measure(self, name: str) -> np.ndarray:
        """Return a quantity of ``rodsim measure`` over time.

        ``writhe``: (T, R), one column for each rod, NaN for those that have none; ``ring.writhe``:
        (T,); of the whole scene: (T,). A vector has three components behind that. Also
        ``my.py:function``. Raises UsageError for an unknown name.
        """
        return measure(self, name)

    def to_xarray(self, measures: Iterable[str] = ()) -> xarray.Dataset:
        """Return all fields and observables as an ``xarray.Dataset`` with units and coordinates.

        ``measures`` : names of quantities that it is to have as well. Needs ``rodsim[table]``.
        """
        return to_xarray(self, measures)

    def to_dataframe(self, measures: Iterable[str] = ()) -> pandas.DataFrame:
        """Return what is known of rods and scene over time as a ``pandas.DataFrame``.

        One row for each frame, the time as index; columns as ``left.power``. ``measures`` : names
        of quantities to add; all observables are there. Needs ``rodsim[table]``.
        """
        return to_dataframe(self, measures)

    def __getitem__(self, name: str) -> RodTrajectory:
        for rod in self.rods:
            if rod.name == name:
                return RodTrajectory(self, rod)
        near = did_you_mean(str(name), self) or f": there is {', '.join(self)}"
        raise UnknownName(f"{self.path}: no rod {name!r}{near}")

    def __iter__(self) -> Iterator[str]:
        return iter(self.rods.names)

    def __contains__(self, name: object) -> bool:
        return name in self.rods.names

    def __repr__(self) -> str:
        return f"<{printable(self._described())}>"

    def _described(self):
        units = self.units
        last = f", t = 0 to {self.time[-1]:g} {units['time']}" if self.frames else ""
        frames = f"{self.frames} of {len(self.planned)} frames{last}"
        title = title_of(self)
        lines = [f"Trajectory {self.path}: {self.status}, {frames}", *([title] if title else [])]
        lines += [_rod_line(rod, units["length"]) for rod in self.rods[:10]]
        if (more := len(self.rods) - 10) > 0:
            lines.append(f"and {more} more rods")
        if self._file.is_open:
            lines.append(f"fields: {', '.join(self.fields)}")
            lines.append(f"observables: {', '.join(self.observables)}")
        else:
            lines.append("closed")
        return "\n  ".join(lines)

    def _keep(self, key, read, name, frames):
        """Return rows of an array that is kept, or read them; keep it where all are read."""
        everything = isinstance(frames, slice) and frames == slice(None)
        if key in self._kept:
            return self._kept[key] if everything else self._kept[key][frames]
        values = read(name, frames)
        if everything:
            values.flags.writeable = False
            self._kept[key] = values
        return values


class RodTrajectory:
    """One rod of a run: T frames, M points, S segments. Values are in the case's units.

    Attributes
    ----------
    run : the :class:`Trajectory`. name. closed : whether its ends meet. points : M.
    spacing, length : of the unstressed rod. moduli : a1, a2, a3, b1, b2, b3.
    s : (M,), arc length of its points. time : (T,).
    """

    def __init__(self, run: Trajectory, rod: Rod):
        self.run, self._rod, self.time = run, rod, run.time
        self.name, self.closed, self.points = rod.name, rod.closed, rod.count
        self.spacing, self.length, self.moduli = rod.spacing, rod.length, rod.moduli
        self.s = rod.points_at

    @property
    def position(self) -> np.ndarray:
        """Positions of its points, (T, M, 3)."""
        return self.read("position")

    @property
    def director(self) -> np.ndarray:
        """Triads of its points, (T, M, 3, 3): [t, point, i, :] is D^(i+1)."""
        return self.read("director")

    @property
    def strain(self) -> np.ndarray:
        """Strain twist of its segments, (T, S, 3): curvatures about D^1, D^2, twist, 1/length."""
        return strain_twist(self.director, self.spacing, self.closed)

    def read(self, name: str) -> np.ndarray:
        """Return a stored field at its points in all frames, (T, M, 3), director (T, M, 3, 3)."""
        if name == "tracers":
            raise UnknownName("tracers belong to no rod: run.tracers has them")
        return self.run.read(name)[:, self._rod.nodes]

    def observable(self, name: str) -> np.ndarray:
        """Return its own column of an observable that every rod has, (T,)."""
        values = self.run.observable(name)
        if name not in reader.layout.PER_ROD:
            raise UnknownName(f"{name} is not of one rod: run.observable({name!r}) has it")
        return values[:, self.run.rods.index(self._rod)]

    def measure(self, name: str) -> np.ndarray:
        """Return a quantity of ``rodsim measure`` over time, (T,), or (T, 3) for a vector."""
        return measure(self.run, name, self.name)

    def __repr__(self) -> str:
        line = _rod_line(self._rod, self.run.units["length"])
        return f"<RodTrajectory {line}, {len(self.time)} frames>"


def _rod_line(rod, unit):
    kind = "closed" if rod.closed else "open"
    return f"{rod.name}: {rod.count} points, {kind}, length {rod.length:.6g} {unit}"
