"""What a frame says of a state: fields of the points, observables of rods and scene."""

import numpy as np

from rodsim.compiled.parts import FLOW, FORCE, HOLD, RELEASE, TRACERS
from rodsim.scene.bodies import observe_nodes
from rodsim.scene.evaluation import Evaluation
from rodsim.scene.state import Scene, State
from rodsim.vectors import cross


class Observer:
    """Computes all fields and observables of a state of a scene."""

    def __init__(self, scene: Scene):
        self.scene = scene
        self._forces = Evaluation(scene, scene.parts.of(FORCE))
        # What parts say of their preparation they can say only of a state they have prepared for.
        tracers = (TRACERS,) if any(part.prepare for part in scene.parts) else ()
        self._flows = Evaluation(scene, scene.parts.of(RELEASE, FLOW, HOLD, *tracers))

    def __call__(
        self, state: State, rates: np.ndarray | None = None, ledger: np.ndarray | None = None
    ) -> tuple[dict, dict]:
        """Return fields and observables.

        ``rates``: (u, w) of the nodes (6, N), ``ledger``: the rates of the ledger, where they are
        known, else they are evaluated.

        Fields: position, director, velocity, angular_velocity, force, torque of the points of rods,
        tracers, as structure of arrays. Observables: those of the parts; power sum_k (g.u + m.w)
        and, where there is a density, kinetic_energy 1/2 rho pi eps^2 sum_k |u_k|^2 ds: (R,);
        net_force sum_k g_k and net_torque sum_k (X_k x g_k + m_k) of all nodes: (3,); the ledger.
        """
        scene, rods = self.scene, self.scene.rods
        loads = np.zeros((6, scene.nodes))
        unmoved = np.zeros((3, state.tracer.shape[1]))
        self._forces.add(state, loads, np.zeros_like(loads), unmoved)
        if rates is None or scene.parts.constrained:  # what holds a node answers to the flow there
            found = np.zeros_like(loads)
            self._flows.add(state, loads, found, unmoved)
            rates = found if rates is None else rates
        observables = {}
        for part in scene.parts:
            if part.observe:
                observables |= part.observe(state, part.row, scene)
        reports, beyond = self._reports(state, ledger)
        observables |= reports | observe_nodes(scene, state, rates)
        points = slice(rods.points)
        observables["power"] = np.add.reduceat((loads * rates)[:, points].sum(axis=0), rods.first)
        if scene.density is not None:
            speed2 = np.add.reduceat((rates[:3, points] ** 2).sum(axis=0), rods.first)
            tube = scene.density * np.pi * scene.epsilon**2
            observables["kinetic_energy"] = 0.5 * tube * speed2 * rods.spacing
        force, torque = _resultant(state, loads)
        observables |= {"net_force": force + beyond[:3], "net_torque": torque + beyond[3:]}
        observables |= self._ledger(state)
        fields = {
            "position": state.position[:, points],
            "director": state.director[:, :, points],
            "velocity": rates[:3, points],
            "angular_velocity": rates[3:, points],
            "force": loads[:3, points],
            "torque": loads[3:, points],
            "tracers": state.tracer,
        }
        return fields, observables

    def _reports(self, state, ledger):
        """Return observables of parts that report, and the net force and torque beyond the loads.

        The gauges are the last numbers of the ledger.
        """
        found, beyond, gauges = {}, np.zeros(6), self.scene.parts.gauge_count
        for part in self.scene.parts:
            if part.report:
                own = None if ledger is None or not ledger.size else ledger[-gauges:]
                seen, more = part.report(self._flows.left_by(part), own, state)
                found |= seen
                beyond += more
        return found, beyond

    def _ledger(self, state):
        """Return what acts from outside, its work since t = 0, and what the fluid dissipated."""
        found, parts = {}, self.scene.parts
        if self._forces.external:
            force, torque = _resultant(state, self._forces.own.sum(axis=0))
            found = {"external_force": force, "external_torque": torque}
        if not parts.external:
            return found
        count = len(parts.working)
        found |= {f"{name}_work": state.work[i] for i, name in enumerate(parts.working)}
        found["external_work"] = state.work[:count].sum()
        found["dissipated"] = state.work[count]
        end = count + 1
        for gauge in parts.gauges:
            begin, end = end, end + gauge.count
            value = state.work[begin:end].reshape(gauge.shape)
            found |= {gauge.name: value} if gauge.shown else {}
            found |= {name: found[name] + value for name in gauge.joins if name in found}
        return found


def _resultant(state, loads):
    """Return sum g and sum (X x g + m)."""
    force, torque = loads[:3], loads[3:]
    arm = cross(state.position, force)
    return force.sum(axis=1), (arm + torque).sum(axis=1)
