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
    """Positions and triads of all nodes, the tracers, and the ledger.

    Nodes are the points of the rods, one rod after another, then what else has a place and a triad
    (bodies). position (3, N), length; director (3, 3, N), [i, component, node] is D^(i+1); tracer
    (3, P); work (W,): what each counted part has done since t = 0, what the fluid dissipated, and
    the gauges of the parts, each times time.
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
    arrays : by rod, what its strain twist was made from beside the case's text, and where its held
    ends are at rest, by name.
    warnings : Problems that do not stop a run, and that only the geometry could tell.
    device : on which its sums are computed, cpu or gpu.
    bodies : its rigid bodies, :class:`rodsim.scene.bodies.Body`.
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
    bodies: tuple = ()
    device: str = "cpu"
    parts: PartList = NO_PARTS

    @property
    def ledger(self) -> int:
        """How many numbers the ledger has: work of each counted part, dissipation, gauges."""
        if not self.parts.external:
            return 0
        return len(self.parts.working) + 1 + self.parts.gauge_count

    @property
    def nodes(self) -> int:
        """Number N of nodes: points of rods, then bodies."""
        return self.initial.position.shape[1]

    def name_of(self, node: int) -> str:
        """Return what a node is, in words."""
        beyond = node - self.rods.points
        if beyond < 0:
            rod, k = self.rods.locate(node)
            return f"rod '{rod}', point {k}"
        if beyond < len(self.bodies):
            return f"body '{self.bodies[beyond].name}'"
        return "the rotor of a hook"

    @property
    def floor(self) -> float:
        """Height below which there is no fluid: the wall, less what rounding may take away."""
        return -math.inf if self.wall is None else self.wall - ON_WALL * self.epsilon

    @property
    def length_scale(self) -> float:
        """Unstressed length of the longest rod."""
        return float(self.rods.lengths.max())
