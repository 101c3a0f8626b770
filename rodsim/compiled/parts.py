"""What acts in a scene: a list of parts."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from rodsim.compiled.kernels import Kernel
from rodsim.compiled.row import Row

PLACE, FORCE, RELEASE, FLOW, HOLD, TRACERS = SIDES = (
    "place", "force", "release", "flow", "hold", "tracers"
)  # fmt: skip


@dataclass(frozen=True)
class Gauge:
    """Numbers whose integrals over time the ledger keeps beside works and dissipation.

    shape : how many they are. joins : the ledger's own entries to which the integral is added as
    well. shown : whether it is an observable of its own name.
    """

    name: str
    dimension: tuple[int, int, int]
    joins: tuple[str, ...] = ()
    shown: bool = True
    shape: tuple[int, ...] = ()

    @property
    def count(self) -> int:
        """How many numbers they are."""
        return math.prod(self.shape)


@dataclass(frozen=True)
class Guard:
    """What a part asks of every step.

    share : called with the displacements and the rotation vectors (3, N) of a step, returns how
    much it takes of what a step may do. Beyond 1 an adaptive method makes the step smaller, a run
    of fixed steps stops.
    beyond : what a share beyond 1 is, in words.
    breach : called with the state at the end of a step, returns what makes it meaningless, the
    usual cause with what to do, and the change of the case for it, or None.
    """

    share: Callable
    beyond: str
    breach: Callable


@dataclass(frozen=True)
class Apart:
    """How far a part keeps rods apart.

    diameter : distance of centrelines at which they touch. excluded (R,) : how many segments apart
    points of a rod are still neighbours. itself : whether it keeps a rod from itself too.
    beside : of scenes with bodies, called with a state: twice the smallest distance of points and
    bodies from surfaces, as far as from their images there.
    """

    diameter: float
    excluded: np.ndarray
    itself: bool
    beside: Callable | None = None


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
    carries : ends of rods that free bodies hold: (node of the body, node, whether clamped).
    adds : forces with an energy that a run has only where constraints are solved.
    move : the farthest that a point may move in one step, length.
    refused : why states at rest cannot be looked for with it, if they cannot.
    """

    exact: Kernel | str | None = None
    stiffness: Callable | None = None
    holds: tuple[int, ...] = ()
    carries: tuple[tuple[int, int, bool], ...] = ()
    adds: tuple = ()
    move: float = math.inf
    refused: str = ""


LOCAL = Statics()


@dataclass(frozen=True)
class Part:
    """One part of a scene: its kernel and its numbers.

    side : ``FORCE`` adds to the loads, ``FLOW`` to the velocities of the nodes, ``TRACERS`` to
    those of tracers, and of any points of the fluid. Three more sides are for constraints:
    ``PLACE`` moves nodes to where they are held, ``RELEASE`` takes the loads off them, ``HOLD``
    finds the loads and velocities that the constraints ask for.
    kernel : or where it is, ``module:name``. row, fixed : what it is called with.
    drive : what a case file calls its row.
    external : it acts from outside, so the ledger is kept: what the fluid dissipates, and the work
    of the part, unless that is kept in an energy of its own (``potential``).
    observe : called with (state, row, scene), returns observables by name.
    series : those beyond the ones of every scene, (name, shape, dimension) each. labels : of those
    with several rows, and of gauges, by name: whose each row is.
    pressure : called with (points (3, T), sources (3, N), loads (6, N), t, left), returns its share
    of the pressure (T,); left: the numbers that it shares with a part that holds, as the
    evaluation of the loads has left them, else None.
    sums : sums that it calls, ``module:name`` each, whose addresses are put into the first places
    of ``fixed`` (an address is a whole number that float64 holds exactly).
    gauges : what it leaves in the last places of ``fixed``. Parts of a scene that
    share one array ``fixed`` share their numbers, what they leave there included.
    report : called with (fixed, rates, state), its numbers after an evaluation and its gauges'
    rates where they are known better than from there, else None; returns observables by name, and
    what the force and torque (6,) about the origin are beyond those of that evaluation.
    guard, apart : what it asks of steps, how far it keeps rods apart, if it does.
    warnings : Problems of the case that do not stop a run.
    statics : what it tells those who look for states at rest.
    prepare : called with (state, loads (6, N)) where a step begins, returns ``fixed`` for that
    step: what depends on the state alone and is to be frozen over a step.
    failed : called after evaluations, raises what has stopped the kernel, which cannot raise.
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
    labels: dict = field(default_factory=dict)
    pressure: Callable | None = None
    sums: tuple[str, ...] = ()
    gauges: tuple[Gauge, ...] = ()
    report: Callable | None = None
    guard: Guard | None = None
    apart: Apart | None = None
    warnings: tuple = ()
    statics: Statics = LOCAL
    prepare: Callable | None = None
    failed: Callable | None = None
    needs: tuple[str, ...] = ()

    @property
    def where(self) -> str:
        """Where its kernel is, ``module:name``."""
        return self.kernel if isinstance(self.kernel, str) else self.kernel.where

    @property
    def works(self) -> bool:
        """Whether its work on the rods is counted."""
        return self.external and not self.potential and self.side in (FORCE, FLOW)


class PartList(tuple):
    """The parts of a scene in the order in which they act, side by side in that of ``SIDES``."""

    def __new__(cls, parts):
        """Sort them; within a side, the order given stays."""
        return super().__new__(cls, sorted(parts, key=lambda part: SIDES.index(part.side)))

    def of(self, *sides: str) -> PartList:
        """Return those of some sides."""
        return PartList(part for part in self if part.side in sides)

    def without(self, side: str) -> PartList:
        """Return those of all sides but one."""
        return PartList(part for part in self if part.side != side)

    @property
    def external(self) -> bool:
        """Whether anything acts from outside: then the ledger is kept."""
        return any(part.external for part in self)

    @property
    def working(self) -> list[str]:
        """Names of the parts whose work is counted, in the order of their accounts."""
        return [part.name for part in self if part.works]

    @property
    def guards(self) -> list[Guard]:
        """What its parts ask of steps."""
        return [part.guard for part in self if part.guard]

    @property
    def apart(self) -> Apart | None:
        """How far rods are kept apart, or None where nothing does."""
        return next((part.apart for part in self if part.apart), None)

    @property
    def gauges(self) -> list[Gauge]:
        """What is integrated beside works and dissipation, in the order of their accounts."""
        return [gauge for part in self for gauge in part.gauges]

    @property
    def gauge_count(self) -> int:
        """How many numbers the gauges are."""
        return sum(gauge.count for gauge in self.gauges)

    @property
    def constrained(self) -> bool:
        """Whether any node is held."""
        return any(part.side == HOLD for part in self)

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
