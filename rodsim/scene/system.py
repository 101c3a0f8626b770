"""The semi-discrete system: state -> rate of change, and what its evaluations cost.

A step of any integrator runs on the increments y from the state at its start: a flat vector of
(X - X_n, theta, tracer - tracer_n, work - work_n), zero at the start of the step. The triads are
exp(theta x) D_n, so they stay orthonormal whatever the integrator does with theta.
"""

from time import perf_counter
from typing import NamedTuple

import numpy as np

from rodsim.compiled.kernels import address_of
from rodsim.compiled.parts import PLACE, TRACERS
from rodsim.compiled.rotations import displace
from rodsim.forces.elasticity import first_half_turn
from rodsim.scene.calls import Calls
from rodsim.scene.evaluation import Evaluation, loads_of
from rodsim.scene.loop import velocities_at
from rodsim.scene.observe import Observer
from rodsim.scene.stages import evaluate_at, product, take_step
from rodsim.scene.state import Scene, State

EVALUATION = address_of(velocities_at)


class Trial(NamedTuple):
    """A step that was tried: how large its error is, its increments, the geometry at its end.

    velocities, rates : there, as (u, w, ...) and as dy/dt; third : y'''.
    """

    error: float
    increment: np.ndarray
    geometry: tuple
    velocities: np.ndarray
    rates: np.ndarray
    third: np.ndarray


class RodSystem:
    """Rates of a scene. Holds the work arrays, counts evaluations and their time."""

    def __init__(self, scene: Scene):
        self.scene = scene
        n, p = scene.nodes, scene.initial.tracer.shape[1]
        parts = scene.parts if p else scene.parts.without(TRACERS)
        self._calls = Calls(parts)
        accounts = self._calls.accounts
        self.rod_size, self._tracers_end = 6 * n, 6 * n + 3 * p
        self.size = self._tracers_end + scene.ledger
        self.observe = Observer(scene)
        self._guards = scene.parts.guards
        self.evaluations = 0
        self.seconds = 0.0
        self._shape = (6, n)
        self._prepared_for = None  # the start of the step that parts have their numbers for
        self._work = self._geometry(p), np.empty((6, n)), np.empty((accounts, 6, n))
        self._probes = np.zeros((2, self.size))
        self._rows = None if self._calls.driven else self._calls.rows_at(np.zeros(1))
        placing = scene.parts.of(PLACE)
        self._placing = Evaluation(scene, placing) if placing else None
        # Lengths count over the rod's own, all others over the longest; angles in radians.
        others = 1.0 / scene.length_scale
        scales = np.full(n, others)
        scales[: scene.rods.points] = np.repeat(1.0 / scene.rods.lengths, scene.rods.count)
        self.weights = np.concatenate([np.tile(scales, 3), np.ones(3 * n), np.full(3 * p, others)])
        # The size of a change of increments: the largest of its parts counts. Of each rod the root
        # mean square, positions over its own length and angles in radians, of each body and of all
        # tracers, over the length of the longest rod. The ledger does not count.
        self.norm = self.weights, *_groups(scene)

    def zeros(self) -> np.ndarray:
        """Return the increments (or rates) of a step's start."""
        return np.zeros(self.size)

    def split(self, y):
        """Return the views position (3, N), rotation vector (3, N), tracer (3, P) of y."""
        nodes = y[: self.rod_size].reshape(self._shape)
        return nodes[:3], nodes[3:], y[self.rod_size : self._tracers_end].reshape(3, -1)

    @property
    def ledger(self) -> slice:
        """Where the ledger lies in y."""
        return slice(self._tracers_end, self.size)

    def guarded(self, increment: np.ndarray) -> float:
        """Return how much a step takes of what the parts let it do; 0 where none asks for that."""
        if not self._guards:
            return 0.0
        return max(guard.share(*self.split(increment)[:2]) for guard in self._guards)

    def rate(self, t: float, base: State, y: np.ndarray, out: np.ndarray) -> np.ndarray:
        """Write dy/dt at increments ``y`` from ``base`` at time ``t`` into ``out``, return it."""
        self._call(evaluate_at, t, base, y, out, True)
        return out

    def velocities(self, t: float, base: State, y: np.ndarray, out: np.ndarray) -> np.ndarray:
        """Write (u, w, u at the tracers, powers) at increments ``y`` from ``base`` into ``out``.

        This is dy/dt of a step that starts there.
        """
        self._call(evaluate_at, t, base, y, out, False)
        return out

    def product(self, base: State, rate: np.ndarray, direction: np.ndarray, size: float, out):
        """Write J ``direction`` at a state into ``out``, both in the scaled norm (6 N).

        ``rate`` : dy/dt there; J v is a difference over ``size``.
        """
        weights = self.weights[: self.rod_size]
        self._call(product, base.time, base, size, direction, rate, weights, self._probes, out)

    def at_start(self, state: State, velocities: np.ndarray | None) -> np.ndarray:
        """Return the velocities at the start of a step.

        ``velocities`` : at the end of the step before, which serve where there are any, unless
        parts freeze some of their numbers over a step: then they are evaluated with the new ones.
        """
        if velocities is not None and not self._calls.prepares:
            return velocities
        return self.velocities(state.time, state, self.zeros(), self.zeros())

    def take_step(self, base: State, size: float, coefficients, f0, correction) -> Trial:
        """Try a step of a three-term recurrence, see :func:`rodsim.scene.stages.take_step`.

        ``f0`` : the rates at its start; ``correction`` : its arguments from c to before. Y_j is at
        time t + c_j h, with c in the last column of ``coefficients``.
        """
        s, begin = len(coefficients) - 1, 2
        vectors = np.empty((7, self.size))
        work = self._geometry(base.tracer.shape[1]), *self._work[1:]
        while begin <= s + 1:  # more than once only where driven rows come in blocks
            rows, count = self._rows, s + 2 - begin
            if rows is None:
                rows = self._calls.rows_at(base.time + size * coefficients[begin - 1 :, 4])
                count = len(rows)
            args = coefficients, begin, count, size, f0, *correction, *self.norm, vectors
            error = self._run(take_step, count, base, rows, work, *args)
            begin += count
        return Trial(error, vectors[s % 2], work[0], vectors[2], vectors[3], vectors[4])

    def _call(self, kernel, t, base, *arguments):
        """Call a kernel that makes one evaluation at time ``t``."""
        rows = self._calls.rows_at(np.array([t])) if self._rows is None else self._rows
        self._run(kernel, 1, base, rows[0], self._work, *arguments)

    def _run(self, kernel, evaluations, base, rows, work, *arguments):
        """Call a kernel that makes evaluations; count and time them."""
        start, calls = perf_counter(), self._calls
        if calls.prepares and base is not self._prepared_for:
            calls.prepare(base, loads_of(self.scene, base))
            self._prepared_for = base
        scene = rows, self.scene.rods.tables, base.geometry, work
        found = kernel(EVALUATION, calls.table, calls.numbers, *scene, *arguments)
        calls.raise_failures()
        self.seconds += perf_counter() - start
        self.evaluations += evaluations
        return found

    def split_seconds(self) -> tuple[float, float]:
        """Return the time of all evaluations, shared between the sums and all else.

        What is not a sum is timed once, here, on the initial state: a clock inside the compiled
        loops would cost more than it measures.
        """
        initial, still, samples = self.scene.initial, self.zeros(), []
        for _ in range(20):
            start = perf_counter()
            displace(initial.geometry, still[: self._tracers_end], self._work[0])
            loads_of(self.scene, initial)
            samples.append(perf_counter() - start)
        elastic = min(self.evaluations * float(np.median(samples)), self.seconds)
        return self.seconds - elastic, elastic

    def state_at(self, base: State, time: float, y: np.ndarray) -> State:
        """Return the state with increments ``y`` from ``base``."""
        end = self._geometry(base.tracer.shape[1])
        displace(base.geometry, y[: self._tracers_end], end)
        state = self._with_work(base, time, y, end)
        if self._placing:
            _, loads, _ = self._work
            self._placing.add(state, loads, loads, state.tracer)
        return state

    def state_after(self, base: State, time: float, trial: Trial) -> State:
        """Return the state after a step from ``base``, at ``time``."""
        if self._placing:  # where nodes are held at that very time, and not at t + c_s h
            return self.state_at(base, time, trial.increment)
        return self._with_work(base, time, trial.increment, trial.geometry)

    def _with_work(self, base, time, y, geometry):
        work = base.work + y[self._tracers_end :] if base.work.size else base.work
        return State(time, *geometry, work)

    def _geometry(self, tracers):
        """Return room for positions, triads and tracers."""
        n = self._shape[1]
        return np.empty((3, n)), np.empty((3, 3, n)), np.empty((3, tracers))

    def diagnose(self, state: State) -> int:
        """Return the first point whose triad is a half-turn from the next one's, or -1."""
        return first_half_turn(state.director, self.scene.rods.tables)


def _groups(scene):
    """Return first node and number of nodes of each rod, then of each node that is of none."""
    rods = scene.rods
    others = np.arange(rods.points, scene.nodes)
    return np.append(rods.first, others), np.append(rods.count, np.ones_like(others))
