"""Parts evaluated at single states: for frames, and for the fluid around a stored run."""

from dataclasses import dataclass

import numpy as np

from rodsim.compiled.parts import FLOW, FORCE, HOLD, RELEASE, TRACERS, Part, PartList
from rodsim.scene.calls import Calls
from rodsim.scene.loop import evaluate
from rodsim.scene.state import Scene, State


class Evaluation:
    """Some parts of a scene. ``own`` (Q, 6, N): of the external ones, what each has added last."""

    def __init__(self, scene: Scene, parts: PartList):
        self.scene = scene
        self._calls = Calls(parts, counted=_acts_on_rods)
        self.external = [part for part in parts if _acts_on_rods(part)]
        self.own = np.empty((self._calls.accounts, 6, scene.nodes))

    def add(self, state: State, loads: np.ndarray, u: np.ndarray, v: np.ndarray) -> None:
        """Let each part add to the loads (6, N), to u (6, N) of the rods or v (3, P) of tracers."""
        now, calls = self._calls.rows_at(np.array([state.time]))[0], self._calls
        rods, geometry = self.scene.rods.tables, state.geometry
        if calls.prepares:
            calls.prepare(state, loads)
        evaluate(calls.table, calls.numbers, now, rods, geometry, loads, (u, v), self.own)
        calls.raise_failures()

    def left_by(self, part: Part) -> np.ndarray:
        """Return the fixed numbers of a part with what its last call has left in them."""
        return self._calls.fixed(part)


def _acts_on_rods(part):
    return part.external and part.side in (FORCE, FLOW)


@dataclass(frozen=True)
class Exerted:
    """What a state exerts on the fluid: loads (6, N) of its nodes, and what constraints have left.

    left : of each part that holds, its numbers, with what is beside the nodes (surfaces of bodies).
    """

    loads: np.ndarray
    left: tuple = ()

    def of(self, part: Part, scene: Scene) -> np.ndarray | None:
        """Return the numbers that a part shares with one that holds, None where it does not."""
        pairs = zip(scene.parts.of(HOLD), self.left, strict=True)
        return next((left for own, left in pairs if own.fixed is part.fixed), None)


def exerted_by(scene: Scene, state: State) -> Exerted:
    """Return what a state exerts on the fluid, after all constraints."""
    if not scene.parts.constrained:
        return Exerted(loads_of(scene, state))
    evaluation = Evaluation(scene, scene.parts.of(FORCE, RELEASE, FLOW, HOLD))
    loads, none = np.zeros((6, scene.nodes)), np.zeros((3, state.tracer.shape[1]))
    evaluation.add(state, loads, np.zeros_like(loads), none)
    left = (evaluation.left_by(part).copy() for part in scene.parts.of(HOLD))
    return Exerted(loads, tuple(left))


def loads_of(scene: Scene, state: State) -> np.ndarray:
    """Return the forces and torques (6, N) of all nodes, before any constraint, on the fluid."""
    loads, none = np.zeros((6, scene.nodes)), np.zeros((3, state.tracer.shape[1]))
    Evaluation(scene, scene.parts.of(FORCE)).add(state, loads, np.zeros_like(loads), none)
    return loads


def fluid_velocity(scene: Scene, state: State, exerted: Exerted) -> np.ndarray:
    """Return the velocity (3, P) of the fluid at the tracers of a state, driven by what it is told.

    The state needs no triads.
    """
    velocity, loads = np.zeros((3, state.tracer.shape[1])), exerted.loads
    evaluation = Evaluation(scene, parts := scene.parts.of(TRACERS))
    for part in parts:
        if (left := exerted.of(part, scene)) is not None:
            evaluation.left_by(part)[:] = left
    evaluation.add(state, loads, np.zeros_like(loads), velocity)
    return velocity
