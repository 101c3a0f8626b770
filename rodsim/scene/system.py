"""The semi-discrete system: state -> rate of change, and what its evaluations cost.

A step of any integrator runs on the increments y from the state at its start: a flat vector of
(X - X_n, theta, tracer - tracer_n), 6 N + 3 P long, zero at the start of the step. The triads are
exp(theta x) D_n, so they stay orthonormal whatever the integrator does with theta.
"""

from time import perf_counter

import numpy as np

from rodsim.compiled.rotations import displace
from rodsim.flows.velocity import BLOBS, velocity_kernel
from rodsim.forces.elasticity import ENERGIES, energies, first_half_turn, point_loads
from rodsim.scene.loop import stage_loop, to_increments
from rodsim.scene.state import Scene, State

NO_STAGES, NOTHING = np.zeros((1, 5)), np.zeros(0)


class RodSystem:
    """Rates of a scene. Holds the work arrays, counts evaluations and their time."""

    def __init__(self, scene: Scene):
        self.scene = scene
        n, p = scene.rods.points, scene.initial.tracer.shape[1]
        self.rod_size, self.size = 6 * n, 6 * n + 3 * p
        self.evaluations = 0
        self.seconds = 0.0
        self._shape = (6, n)
        self._work = np.empty((3, n)), np.empty((3, 3, n)), np.empty((3, p)), *np.empty((2, 6, n))
        self._velocity = velocity_kernel(BLOBS[scene.blob], scene.planar)
        self._loop = stage_loop(BLOBS[scene.blob], scene.planar, p > 0)
        self._fixed = scene.rods.tables, (scene.epsilon, scene.viscosity)
        driven = scene.strain_twist.driven
        self._omegas = None if driven else scene.strain_twist.at(np.zeros(1))
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
        self.velocities(t, base, y, out)
        to_increments(y[: self.rod_size], out[: self.rod_size])
        return out

    def velocities(self, t: float, base: State, y: np.ndarray, out: np.ndarray) -> np.ndarray:
        """Write (u, w, u at the tracers) at increments ``y`` from ``base`` into ``out``.

        This is dy/dt of a step that starts there.
        """
        self.run_stages(t, base, y, out)
        return out

    def run_stages(
        self, t, base, Y, out, table=NO_STAGES, begin=1, end=1, size=0.0, f0=NOTHING, g=NOTHING
    ):
        """Run stages of a recurrence, see :func:`rodsim.scene.loop.stage_loop`, then evaluate.

        The evaluation at Y_j is at time t + c_j h, with c in the last column of ``table``. Returns
        how many were made: of a driven scene, as many as there is room for strain twist, the last
        of them without its stage.
        """
        omegas = self._omegas
        if omegas is None:
            omegas = self.scene.strain_twist.at(t + size * table[begin - 1 :, 4])
            end = begin + len(omegas) - 1
        state, Y = (base.position, base.director, base.tracer), Y.reshape(-1, self.size)
        start = perf_counter()
        self._loop(*self._fixed, state, self._work, omegas, table, begin, end, size, f0, g, Y, out)
        self.seconds += perf_counter() - start
        self.evaluations += end + 1 - begin
        return end + 1 - begin

    def split_seconds(self) -> tuple[float, float]:
        """Return the time of all evaluations, shared between the sums and all else.

        What is not a sum is timed once, here, on the initial state: a clock inside the compiled
        loops would cost more than it measures.
        """
        initial, still, samples = self.scene.initial, self.zeros(), []
        begin = initial.position, initial.director, initial.tracer
        for _ in range(20):
            start = perf_counter()
            displace(begin, still, self._work[:3])
            self._point_loads(initial)
            samples.append(perf_counter() - start)
        elastic = min(self.evaluations * float(np.median(samples)), self.seconds)
        return self.seconds - elastic, elastic

    def state_at(self, base: State, time: float, y: np.ndarray) -> State:
        """Return the state with increments ``y`` from ``base``."""
        begin = base.position, base.director, base.tracer
        end = tuple(np.empty_like(part) for part in begin)
        displace(begin, y, end)
        return State(time, *end)

    def diagnose(self, state: State) -> int:
        """Return the first point whose triad is a half-turn from the next one's, or -1."""
        return first_half_turn(state.director, self.scene.rods.tables)

    def observe(self, state: State, rates: np.ndarray | None = None) -> tuple[dict, dict]:
        """Return all fields and observables of a state, for a frame.

        ``rates``: (u, w) of the rods (6, N) where they are known, else they are evaluated.

        Fields: position, director, velocity, angular_velocity, force, torque, tracers, as
        structure of arrays. Observables: the energies (6), power sum_k (g.u + m.w), length,
        kinetic_energy 1/2 rho pi eps^2 sum_k |u_k|^2 ds where there is a density: (R,);
        net_force sum_k g_k and net_torque sum_k (X_k x g_k + m_k): (3,).
        """
        scene, rods = self.scene, self.scene.rods
        X, loads = state.position, self._point_loads(state)
        if rates is None:
            rates = np.empty(self._shape)
            self._velocity(X, X, loads, scene.epsilon, scene.viscosity, rates)
        split, length = np.empty((4, len(rods.names))), np.empty(len(rods.names))
        energies(X, state.director, scene.strain_twist(state.time), rods.tables, split, length)
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

    def _point_loads(self, state):
        internal, loads = self._work[3:]
        omega = self.scene.strain_twist(state.time)
        point_loads(state.position, state.director, omega, self.scene.rods.tables, internal, loads)
        return loads
