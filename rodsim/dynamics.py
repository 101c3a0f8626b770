"""The semi-discrete system: state -> rate of change, and what its evaluations cost.

A step of any integrator runs on the increments y from the state at its start: a flat vector of
(X - X_n, theta, tracer - tracer_n), 6 N + 3 P long, zero at the start of the step. The triads are
exp(theta x) D_n, so they stay orthonormal whatever the integrator does with theta.
"""

from time import perf_counter

import numpy as np

from rodsim.elasticity import ENERGIES, energies, first_half_turn, point_loads
from rodsim.fluid import BLOBS, velocity_kernel
from rodsim.rods.state import Scene, State
from rodsim.rotations import rotate, rotation_vector_rate


class RodSystem:
    """Rates of a scene. Holds the work arrays, counts evaluations, times their two parts."""

    def __init__(self, scene: Scene):
        self.scene = scene
        n, p = scene.rods.points, scene.initial.tracer.shape[1]
        self.rod_size, self.size = 6 * n, 6 * n + 3 * p
        self.evaluations = 0
        self.sum_seconds = 0.0
        self.elastic_seconds = 0.0
        self._shape = (6, n)
        self._position = np.empty((3, n))
        self._director = np.empty((3, 3, n))
        self._tracer = np.empty((3, p))
        self._internal = np.empty((6, n))
        self._loads = np.empty((6, n))
        self._velocity = velocity_kernel(BLOBS[scene.blob], scene.planar)
        if p:
            self._flow = velocity_kernel(BLOBS[scene.blob], False, angular=False)
        # Error norms measure lengths against the longest rod and angles in radians.
        self.weights = np.ones(self.size)
        self.weights[: 3 * n] = self.weights[6 * n :] = 1.0 / scene.length_scale

    def zeros(self) -> np.ndarray:
        """Return the increments (or rates) of a step's start."""
        return np.zeros(self.size)

    def split(self, y):
        """Return the views position (3, N), rotation vector (3, N), tracer (3, P) of y."""
        rods = y[: self.rod_size].reshape(self._shape)
        return rods[:3], rods[3:], y[self.rod_size :].reshape(3, -1)

    def rate(self, t: float, base: State, y: np.ndarray, out: np.ndarray) -> np.ndarray:
        """Write dy/dt at increments ``y`` from ``base`` at time ``t`` into ``out``, return it."""
        return self.to_increments(y, self.velocities(t, base, y, out))

    def to_increments(self, y: np.ndarray, velocities: np.ndarray) -> np.ndarray:
        """Turn velocities at increments ``y`` into dy/dt, in place: w becomes d theta/dt."""
        rotation_vector_rate(self.split(y)[1], self.split(velocities)[1])
        return velocities

    def velocities(self, t: float, base: State, y: np.ndarray, out: np.ndarray) -> np.ndarray:
        """Write (u, w, u at the tracers) at increments ``y`` from ``base`` into ``out``.

        This is dy/dt of a step that starts there.
        """
        start = perf_counter()
        shift, theta, drift = self.split(y)
        np.add(base.position, shift, out=self._position)
        rotate(theta, base.director, self._director)
        loads = self._point_loads(t, self._position, self._director)
        middle = perf_counter()
        rates = out[: self.rod_size].reshape(self._shape)
        fluid = self.scene.epsilon, self.scene.viscosity
        self._velocity(self._position, self._position, loads, *fluid, rates)
        if drift.size:
            np.add(base.tracer, drift, out=self._tracer)
            flow = out[self.rod_size :].reshape(3, -1)
            self._flow(self._tracer, self._position, loads, *fluid, flow)
        self.evaluations += 1
        self.elastic_seconds += middle - start
        self.sum_seconds += perf_counter() - middle
        return out

    def state_at(self, base: State, time: float, y: np.ndarray) -> State:
        """Return the state with increments ``y`` from ``base``."""
        shift, theta, drift = self.split(y)
        director = np.empty_like(base.director)
        rotate(theta, base.director, director)
        return State(time, base.position + shift, director, base.tracer + drift)

    def diagnose(self, state: State) -> int:
        """Return the first point whose triad is a half-turn from the next one's, or -1."""
        return first_half_turn(state.director, self.scene.rods.tables)

    def observe(self, state: State) -> tuple[dict, dict]:
        """Return all fields and observables of a state, for a frame.

        Fields: position, director, velocity, angular_velocity, force, torque, tracers, as
        structure of arrays. Observables: the energies (6), power sum_k (g.u + m.w), length,
        kinetic_energy 1/2 rho pi eps^2 sum_k |u_k|^2 ds where there is a density: (R,);
        net_force sum_k g_k and net_torque sum_k (X_k x g_k + m_k): (3,).
        """
        scene, rods = self.scene, self.scene.rods
        loads = self._point_loads(state.time, state.position, state.director)
        rates = np.empty(self._shape)
        self._velocity(state.position, state.position, loads, scene.epsilon, scene.viscosity, rates)
        split, length = np.empty((4, len(rods.names))), np.empty(len(rods.names))
        energies(
            state.position,
            state.director,
            scene.strain_twist(state.time),
            rods.tables,
            split,
            length,
        )
        observables = dict(zip(ENERGIES, split, strict=True))
        observables["power"] = np.add.reduceat((loads * rates).sum(axis=0), rods.first)
        observables["length"] = length
        if scene.density is not None:
            speed2 = np.add.reduceat((rates[:3] ** 2).sum(axis=0), rods.first)
            tube = scene.density * np.pi * scene.epsilon**2
            observables["kinetic_energy"] = 0.5 * tube * speed2 * rods.spacing
        force, torque = loads[:3], loads[3:]
        observables["net_force"] = force.sum(axis=1)
        arm = np.cross(state.position, force, axis=0)
        observables["net_torque"] = (arm + torque).sum(axis=1)
        fields = {
            "position": state.position,
            "director": state.director,
            "velocity": rates[:3],
            "angular_velocity": rates[3:],
            "force": force,
            "torque": torque,
            "tracers": state.tracer,
        }
        return fields, observables

    def _point_loads(self, t, position, director):
        omega = self.scene.strain_twist(t)
        point_loads(position, director, omega, self.scene.rods.tables, self._internal, self._loads)
        return self._loads
