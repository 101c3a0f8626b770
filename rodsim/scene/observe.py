"""What a frame says of a state: fields of the points, observables of rods and scene."""

import numpy as np

from rodsim.compiled.parts import FLOW, FORCE, TRACERS
from rodsim.scene.evaluation import Evaluation
from rodsim.scene.state import Scene, State


class Observer:
    """Computes all fields and observables of a state of a scene."""

    def __init__(self, scene: Scene):
        self.scene = scene
        self._forces = Evaluation(scene, scene.parts.of(FORCE))
        # What parts say of their preparation they can say only of a state they have prepared for.
        sides = (FLOW, TRACERS) if any(part.prepare for part in scene.parts) else (FLOW,)
        self._flows = Evaluation(scene, scene.parts.of(*sides))

    def __call__(self, state: State, rates: np.ndarray | None = None) -> tuple[dict, dict]:
        """Return fields and observables.

        ``rates``: (u, w) of the rods (6, N) where they are known, else they are evaluated.

        Fields: position, director, velocity, angular_velocity, force, torque, tracers, as
        structure of arrays. Observables: those of the parts; power sum_k (g.u + m.w) and, where
        there is a density, kinetic_energy 1/2 rho pi eps^2 sum_k |u_k|^2 ds: (R,); net_force
        sum_k g_k and net_torque sum_k (X_k x g_k + m_k): (3,); and the ledger.
        """
        scene, rods = self.scene, self.scene.rods
        loads = np.zeros((6, rods.points))
        unmoved = np.zeros((3, state.tracer.shape[1]))
        self._forces.add(state, loads, np.zeros_like(loads), unmoved)
        if rates is None:
            rates = np.zeros_like(loads)
            self._flows.add(state, loads, rates, unmoved)
        observables = {}
        for part in scene.parts:
            if part.observe:
                observables |= part.observe(state, part.row, scene)
        observables["power"] = np.add.reduceat((loads * rates).sum(axis=0), rods.first)
        if scene.density is not None:
            speed2 = np.add.reduceat((rates[:3] ** 2).sum(axis=0), rods.first)
            tube = scene.density * np.pi * scene.epsilon**2
            observables["kinetic_energy"] = 0.5 * tube * speed2 * rods.spacing
        observables["net_force"], observables["net_torque"] = _resultant(state, loads)
        observables |= self._ledger(state)
        fields = {
            "position": state.position,
            "director": state.director,
            "velocity": rates[:3],
            "angular_velocity": rates[3:],
            "force": loads[:3],
            "torque": loads[3:],
            "tracers": state.tracer,
        }
        return fields, observables

    def _ledger(self, state):
        """Return what acts from outside, its work since t = 0, and what the fluid dissipated."""
        found, working = {}, self.scene.parts.working
        if self._forces.external:
            force, torque = _resultant(state, self._forces.own.sum(axis=0))
            found = {"external_force": force, "external_torque": torque}
        if self.scene.parts.external:
            found |= {f"{name}_work": state.work[i] for i, name in enumerate(working)}
            found["external_work"] = state.work[:-1].sum()
            found["dissipated"] = state.work[-1]
        return found


def _resultant(state, loads):
    """Return sum g and sum (X x g + m)."""
    force, torque = loads[:3], loads[3:]
    arm = np.cross(state.position, force, axis=0)
    return force.sum(axis=1), (arm + torque).sum(axis=1)
