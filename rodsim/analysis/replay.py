"""A stored run evaluated again: what the rods of its frames do to the fluid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rodsim.blocks.skins import between, with_loads
from rodsim.case.methods import METHODS
from rodsim.compiled.parts import TRACERS
from rodsim.scene.evaluation import Exerted, exerted_by, fluid_velocity
from rodsim.scene.restore import restore_scene, stored_state
from rodsim.scene.state import Scene, State

EXACT = 1e-6  # tolerance of a run from which on settling adds more error than it takes away
NO_TRIADS = np.zeros((3, 3, 0))  # the fluid does not ask for them
SETTLING = 10  # Euler steps that let the fastest modes of a frame come to rest


@dataclass(frozen=True)
class Sources:
    """Where all nodes are, what they and the bodies exert on the fluid at a time, and the scene.

    position (3, N): points of rods, then other nodes. The loads of a body's node are those of its
    surface together, which drives the fluid in its place.
    """

    time: float
    position: np.ndarray
    exerted: Exerted
    scene: Scene

    @property
    def loads(self) -> np.ndarray:
        """Point forces, then point torques, of all nodes: (6, N)."""
        return self.exerted.loads

    @property
    def points(self) -> np.ndarray:
        """Positions (n, 3) of the points of the rods."""
        return self.position[:, : self.scene.rods.points].T

    def velocity(self, points) -> np.ndarray:
        """Return the velocity (n, 3) of the fluid at points (n, 3): what tracers there would have.

        By the same parts that move the tracers of the run.
        """
        points = np.ascontiguousarray(np.asarray(points, float).T)
        state = State(self.time, self.position, NO_TRIADS, points)
        return fluid_velocity(self.scene, state, self.exerted).T.copy()

    def pressure(self, points) -> np.ndarray:
        """Return the pressure (n,) at points (n, 3), the sum of what the parts have of it."""
        points = np.ascontiguousarray(np.asarray(points, float).T)
        given, n = [part for part in self.scene.parts if part.pressure], self.scene.rods.points
        sources = points, *(np.ascontiguousarray(a[:, :n]) for a in (self.position, self.loads))
        left = (self.exerted.of(part, self.scene) for part in given)
        pairs = zip(given, left, strict=True)
        return sum(part.pressure(*sources, self.time, numbers) for part, numbers in pairs)

    def towards(self, other: Sources, share: float) -> Sources:
        """Return the sources a share of the way from these to others, along straight lines."""
        pairs = ((getattr(s, n) for s in (self, other)) for n in ("time", "position", "loads"))
        time, position, loads = ((1.0 - share) * a + share * b for a, b in pairs)
        lefts = zip(self.exerted.left, other.exerted.left, strict=True)
        left = tuple(between(a, b, share) for a, b in lefts)
        return Sources(time, position, Exerted(loads, left), self.scene)


class Replay:
    """The frames of a stored run; the file alone is enough, but it must hold the triads."""

    def __init__(self, run, device=None):
        """``run``: what :func:`rodsim.open_trajectory` returns. ``device``: of the sums."""
        self.run = run
        self.scene = restore_scene(run, device)
        time = run.case_data()["time"]
        self.rough = METHODS[time["integrator"]].adaptive and time["tolerance"] > EXACT

    @cached_property
    def _machinery(self):
        """The system of the scene and its fastest rate; compiled only where states are moved."""
        from rodsim.integrators.fastest_rate import FastestRate
        from rodsim.scene.system import RodSystem

        system = RodSystem(self.scene)
        return system, FastestRate(system)

    @property
    def without_pressure(self) -> list[str]:
        """What moves the fluid and has a pressure that nobody knows, in words of the case file."""
        return [part.drive for part in self.scene.parts.of(TRACERS) if part.pressure is None]

    def sources(self, frame: int) -> Sources:
        """Return what a frame exerts on the fluid: rods by eqs. (30), (31), and what holds them."""
        state = stored_state(self.run, frame)
        return Sources(state.time, state.position, exerted_by(self.scene, state), self.scene)

    def settled_sources(self, frame: int) -> Sources:
        """Return the same without what the fastest modes of the rods hold by mistake.

        Most frames lie inside long steps of the integrator. What is left of its error there is
        small in the positions, but in a stiff mode a small error is a large force. So the rods go
        on for n = 10 Euler steps of 1/rho, rho the fastest rate, and for 20; the loads at the
        frame's own time are 2 g_n - g_2n. A mode of rate lambda keeps the share
        2 (1 - x)^n - (1 - x)^2n with x = lambda/rho: all to second order where n x is small, less
        than 6 % above x = 0.3. What it takes from modes that are still moving makes up to 1 % of
        the velocity, so frames that are better than that are left as they are: the first one, those
        of fixed steps, and those of a run at a tolerance of 1e-6 or less.
        """
        state, after = stored_state(self.run, frame, self.scene.ledger), []
        rate = self._machinery[1].estimate(state) if frame and self.rough else 0.0
        if not (np.isfinite(rate) and rate > 0.0):
            return self.sources(frame)
        time, position, now = state.time, state.position, exerted_by(self.scene, state)
        for _ in range(2):
            state = self._settle(state, 1.0 / rate)
            after.append(exerted_by(self.scene, state))
        loads = 2.0 * after[0].loads - after[1].loads
        lefts = zip(now.left, *(exerted.left for exerted in after), strict=True)
        left = tuple(with_loads(own, (2.0, a), (-1.0, b)) for own, a, b in lefts)
        return Sources(time, position, Exerted(loads, left), self.scene)

    def _settle(self, state, step):
        system, _ = self._machinery
        zero, out = system.zeros(), np.empty(system.size)
        for _ in range(SETTLING):
            increment = step * system.rate(state.time, state, zero, out)
            state = system.state_at(state, state.time + step, increment)
        return state

    def settled_velocity(self, frame: int) -> np.ndarray:
        """Return the velocity (N, 3) of all points of the rods in a frame."""
        sources = self.settled_sources(frame)
        return sources.velocity(sources.points)
