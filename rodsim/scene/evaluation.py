"""Parts evaluated at single states: for frames, and for the fluid around a stored run."""

import numpy as np

from rodsim.compiled.parts import FLOW, FORCE, TRACERS, Part, PartList
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

    def left_by(self, part: Part) -> np.ndarray:
        """Return the fixed numbers of a part with what its last call has left in them."""
        return self._calls.fixed(part)


def _acts_on_rods(part):
    return part.external and part.side in (FORCE, FLOW)


def loads_of(scene: Scene, state: State) -> np.ndarray:
    """Return the forces and torques (6, N) of all nodes, before any constraint, on the fluid."""
    loads, none = np.zeros((6, scene.nodes)), np.zeros((3, state.tracer.shape[1]))
    Evaluation(scene, scene.parts.of(FORCE)).add(state, loads, np.zeros_like(loads), none)
    return loads


def fluid_velocity(scene: Scene, state: State, loads: np.ndarray) -> np.ndarray:
    """Return the velocity (3, P) of the fluid at the tracers of a state, driven by given loads."""
    velocity = np.zeros((3, state.tracer.shape[1]))
    Evaluation(scene, scene.parts.of(TRACERS)).add(state, loads, np.zeros_like(loads), velocity)
    return velocity
