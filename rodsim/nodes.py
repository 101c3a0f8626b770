"""The nodes of a scene: the points of its rods, one rod after another. Memory, file and kernels
share these tables."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class Rod:
    """What never changes of one rod.

    ``first``, ``count`` : its nodes. ``spacing`` : ds, length. ``moduli`` : a_1, a_2, a_3
    (mass length^3 time^-2), b_1, b_2, b_3 (mass length time^-2).
    """

    name: str
    first: int
    count: int
    closed: bool
    spacing: float
    moduli: tuple[float, ...]

    @property
    def nodes(self) -> slice:
        """Its place among the nodes of all rods."""
        return slice(self.first, self.first + self.count)

    @property
    def segments(self) -> int:
        """Number of segments: that of an open rod's last node does not exist."""
        return self.count if self.closed else self.count - 1

    @property
    def length(self) -> float:
        """Unstressed length."""
        return self.segments * self.spacing

    @property
    def points_at(self) -> np.ndarray:
        """Arc length s of its points, (count,)."""
        return np.arange(self.count) * self.spacing

    @property
    def middles_at(self) -> np.ndarray:
        """Arc length s of the middles of its segments, (segments,)."""
        return (np.arange(self.segments) + 0.5) * self.spacing


class Rods(tuple):
    """All rods of a scene, in order: a tuple of :class:`Rod`, and the same as arrays (R,)."""

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Their names."""
        return tuple(rod.name for rod in self)

    @cached_property
    def first(self) -> np.ndarray:
        """The first node of each."""
        return np.array([rod.first for rod in self], dtype=np.int64)

    @cached_property
    def count(self) -> np.ndarray:
        """The number of nodes of each."""
        return np.array([rod.count for rod in self], dtype=np.int64)

    @cached_property
    def closed(self) -> np.ndarray:
        """Whether each is closed."""
        return np.array([rod.closed for rod in self], dtype=np.bool_)

    @cached_property
    def spacing(self) -> np.ndarray:
        """The spacing ds of each."""
        return np.array([rod.spacing for rod in self], dtype=float)

    @cached_property
    def moduli(self) -> np.ndarray:
        """The moduli of all, (6, R)."""
        return np.array([rod.moduli for rod in self], dtype=float).T.copy()

    @cached_property
    def points(self) -> int:
        """Number of points N of all rods."""
        return int(self.count.sum())

    @cached_property
    def tables(self):
        """The argument ``rods`` of every kernel: first, count, closed, spacing, moduli."""
        return self.first, self.count, self.closed, self.spacing, self.moduli

    @cached_property
    def segments(self) -> np.ndarray:
        """Number of segments of each rod, (R,)."""
        return np.where(self.closed, self.count, self.count - 1)

    @cached_property
    def lengths(self) -> np.ndarray:
        """Unstressed length of each rod, (R,)."""
        return self.segments * self.spacing

    def locate(self, point: int) -> tuple[str, int]:
        """Return the rod's name and the number within it of a point of the whole scene."""
        r = int(np.searchsorted(self.first, point, side="right")) - 1
        return self.names[r], int(point - self.first[r])


def lay_out(entries) -> Rods:
    """Return the rods of entries (name, count, closed, spacing, moduli), one after another."""
    rods, first = [], 0
    for name, count, closed, spacing, moduli in entries:
        rods.append(Rod(name, first, int(count), bool(closed), float(spacing), tuple(moduli)))
        first += int(count)
    return Rods(rods)
