"""What acts in a scene: a list of parts."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from rodsim.compiled.kernels import Kernel
from rodsim.compiled.row import Row

FORCE, FLOW, TRACERS = "force", "flow", "tracers"


@dataclass(frozen=True)
class Statics:
    """What a force tells those who look for states at rest, beside its loads and its energy.

    A force that acts on each node by that node's own position and triad, or on neighbours along a
    rod, need not say anything: its derivatives are taken by differences.

    exact : the kernel, or where it is, of the exact gradient of its energy, where its own is not.
    stiffness : of a force that couples other nodes: called with (state, row, scene), returns
    (i, j, blocks) with -d(load of node i)/d(z of node j) to be added up; i, j (n,), blocks
    (n, 3, 3) of positions alone, or (n, 6, 6) of positions and rotation vectors.
    holds : degrees of freedom that it keeps where they are, c N + k for component c (x, y, z, then
    three of the rotation vector) of node k.
    move : the farthest that a point may move in one step, length.
    """

    exact: Kernel | str | None = None
    stiffness: Callable | None = None
    holds: tuple[int, ...] = ()
    move: float = math.inf


LOCAL = Statics()


@dataclass(frozen=True)
class Part:
    """One part of a scene: its kernel and its numbers.

    side : ``FORCE`` adds to the loads, ``FLOW`` to the velocities of the rods, ``TRACERS`` to those
    of tracers, and of any points of the fluid.
    kernel : or where it is, ``module:name``. row, fixed : what it is called with.
    drive : what a case file calls its row.
    external : it acts from outside, so the ledger is kept: what the fluid dissipates, and the work
    of the part, unless that is kept in an energy of its own (``potential``).
    observe : called with (state, row, scene), returns observables by name.
    series : those beyond the ones of every scene, (name, shape, dimension) each.
    pressure : called with (points (3, T), sources (3, N), loads (6, N), t), returns its share of
    the pressure (T,).
    statics : what it tells those who look for states at rest.
    """

    name: str
    side: str
    kernel: Kernel | str
    row: Row = field(default_factory=lambda: Row(0))
    fixed: np.ndarray = field(default_factory=lambda: np.zeros(0))
    drive: str = "a number"
    external: bool = False
    potential: bool = False
    observe: Callable | None = None
    series: tuple = ()
    pressure: Callable | None = None
    statics: Statics = LOCAL

    @property
    def where(self) -> str:
        """Where its kernel is, ``module:name``."""
        return self.kernel if isinstance(self.kernel, str) else self.kernel.where

    @property
    def works(self) -> bool:
        """Whether its work on the rods is counted."""
        return self.external and not self.potential and self.side != TRACERS


class PartList(tuple):
    """The parts of a scene in the order in which they act: forces before flows."""

    def __new__(cls, parts):
        """Sort them; within a side, the order given stays."""
        order = (FORCE, FLOW, TRACERS)
        return super().__new__(cls, sorted(parts, key=lambda part: order.index(part.side)))

    def of(self, *sides: str) -> PartList:
        """Return those of some sides."""
        return PartList(part for part in self if part.side in sides)

    @property
    def external(self) -> bool:
        """Whether anything acts from outside: then the ledger is kept."""
        return any(part.external for part in self)

    @property
    def working(self) -> list[str]:
        """Names of the parts whose work is counted, in the order of their accounts."""
        return [part.name for part in self if part.works]

    @property
    def driven(self) -> bool:
        """Whether a number of any part depends on time."""
        return any(part.row.driven for part in self)

    def travel(self, t: float, size: float) -> float:
        """Return how far the farthest drive goes from t to t + size, see :meth:`Row.travel`."""
        return max((part.row.travel(t, size) for part in self if part.row.driven), default=0.0)

    def not_finite(self, t: float) -> str:
        """Return what a case file calls those numbers that are not finite at time t, or nothing."""
        names = (part.drive for part in self if not np.isfinite(part.row(t)).all())
        return next(names, "")
