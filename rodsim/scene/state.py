"""A scene: its rods, its fluid, its parts, its initial state."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from rodsim.compiled.constants import ON_WALL
from rodsim.compiled.parts import PartList
from rodsim.nodes import Rods

NO_WORK, NO_PARTS = np.zeros(0), PartList(())


@dataclass
class State:
    """Positions and triads of all rods, one rod after another, the tracers, and the ledger.

    position (3, N), length; director (3, 3, N), [i, component, point] is D^(i+1); tracer (3, P);
    work (W,): what each counted part has done and the fluid dissipated since t = 0, energy.
    """

    time: float
    position: np.ndarray
    director: np.ndarray
    tracer: np.ndarray
    work: np.ndarray = field(default_factory=lambda: NO_WORK)

    @property
    def geometry(self):
        """The argument ``state`` of every kernel: position, director, tracer."""
        return self.position, self.director, self.tracer


@dataclass(frozen=True)
class Scene:
    """A case made ready to run.

    wall : its height, or None where there is none.
    entries : of each rod, its strain twist, three numbers or functions of s and t.
    along (9, N) : where moduli vary or rods are at rest as they are built, six moduli and three
    rest strains (shear, stretch) of each segment.
    arrays : by rod, what its strain twist was made from beside the case's text, by name.
    warnings : Problems that do not stop a run, and that only the geometry could tell.
    """

    rods: Rods
    epsilon: float
    viscosity: float
    blob: str
    planar: bool
    density: float | None
    tracer_groups: dict[str, int]
    initial: State
    wall: float | None = None
    entries: tuple = ()
    along: np.ndarray | None = None
    arrays: dict = field(default_factory=dict)
    warnings: tuple = ()
    parts: PartList = NO_PARTS

    @property
    def ledger(self) -> int:
        """How many numbers the ledger has: the work of each counted part, what is dissipated."""
        return len(self.parts.working) + 1 if self.parts.external else 0

    @property
    def floor(self) -> float:
        """Height below which there is no fluid: the wall, less what rounding may take away."""
        return -math.inf if self.wall is None else self.wall - ON_WALL * self.epsilon

    @property
    def length_scale(self) -> float:
        """Unstressed length of the longest rod."""
        return float(self.rods.lengths.max())
