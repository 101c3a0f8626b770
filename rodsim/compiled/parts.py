"""What acts in a scene: a list of parts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from rodsim.compiled.kernels import Kernel
from rodsim.compiled.row import Row

FORCE, FLOW, TRACERS = "force", "flow", "tracers"


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
    prepare : called with (state, loads (6, N)) where a step begins, returns ``fixed`` for that
    step: what depends on the state alone and is to be frozen over a step.
    needs : where the kernels are that ``prepare`` calls beside the part's own, if any.
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
    prepare: Callable | None = None
    needs: tuple[str, ...] = ()

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
