"""The semi-discrete system: state -> rate of change, and what its evaluations cost.

A step of any integrator runs on the increments y from the state at its start: a flat vector of
(X - X_n, theta, tracer - tracer_n, work - work_n), zero at the start of the step. The triads are
exp(theta x) D_n, so they stay orthonormal whatever the integrator does with theta.
"""

from time import perf_counter

import numpy as np

from rodsim.compiled.parts import PLACE, TRACERS
from rodsim.compiled.rotations import displace
from rodsim.forces.elasticity import first_half_turn
from rodsim.scene.calls import Calls
from rodsim.scene.evaluation import Evaluation, loads_of
from rodsim.scene.loop import run_stages, to_increments
from rodsim.scene.observe import Observer
from rodsim.scene.state import Scene, State

NO_STAGES, NOTHING = np.zeros((1, 5)), np.zeros(0)


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
        geometry = np.empty((3, n)), np.empty((3, 3, n)), np.empty((3, p))
        self._work = geometry, np.empty((6, n)), np.empty((accounts, 6, n))
        self._rows = None if self._calls.driven else self._calls.rows_at(np.zeros(1))
        placing = scene.parts.of(PLACE)
        self._placing = Evaluation(scene, placing) if placing else None
        # Lengths count over the rod's own, all others over the longest; angles in radians.
        others = 1.0 / scene.length_scale
        scales = np.full(n, others)
        scales[: scene.rods.points] = np.repeat(1.0 / scene.rods.lengths, scene.rods.count)
        self.weights = np.concatenate([np.tile(scales, 3), np.ones(3 * n), np.full(3 * p, others)])
        self._groups = _groups(scene)

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

    @property
    def norm(self) -> tuple[np.ndarray, ...]:
        """What the size of a change of increments is taken with: the largest of its parts counts.

        Of each rod the root mean square, positions over its own length and angles in radians, of
        each body and of all tracers, over the length of the longest rod. The ledger does not count.
        """
        return self.weights, *self._groups

    def guarded(self, increment: np.ndarray) -> float:
        """Return how much a step takes of what the parts let it do; 0 where none asks for that."""
        if not self._guards:
            return 0.0
        return max(guard.share(*self.split(increment)[:2]) for guard in self._guards)

    def rate(self, t: float, base: State, y: np.ndarray, out: np.ndarray) -> np.ndarray:
        """Write dy/dt at increments ``y`` from ``base`` at time ``t`` into ``out``, return it."""
        self.velocities(t, base, y, out)
        to_increments(y[: self.rod_size], out[: self.rod_size])
        return out

    def velocities(self, t: float, base: State, y: np.ndarray, out: np.ndarray) -> np.ndarray:
        """Write (u, w, u at the tracers, powers) at increments ``y`` from ``base`` into ``out``.

        This is dy/dt of a step that starts there.
        """
        self.run_stages(t, base, y, out)
        return out

    def at_start(self, state: State, velocities: np.ndarray | None) -> np.ndarray:
        """Return the velocities at the start of a step.

        ``velocities`` : at the end of the step before, which serve where there are any, unless
        parts freeze some of their numbers over a step: then they are evaluated with the new ones.
        """
        if velocities is not None and not self._calls.prepares:
            return velocities
        return self.velocities(state.time, state, self.zeros(), self.zeros())

    def run_stages(
        self, t, base, Y, out, table=NO_STAGES, begin=1, end=1, size=0.0, f0=NOTHING, g=NOTHING
    ):
        """Run stages of a recurrence, see :func:`rodsim.scene.loop.run_stages`, then evaluate.

        The evaluation at Y_j is at time t + c_j h, with c in the last column of ``table``. Returns
        how many were made: of a driven scene, as many as there is room for its rows, the last of
        them without its stage.
        """
        rows = self._rows
        if rows is None:
            rows = self._calls.rows_at(t + size * table[begin - 1 :, 4])
            end = begin + len(rows) - 1
        start, rods = perf_counter(), self.scene.rods.tables
        if self._calls.prepares and base is not self._prepared_for:
            self._calls.prepare(base, loads_of(self.scene, base))
            self._prepared_for = base
        calls, Y = (self._calls.table, self._calls.numbers), Y.reshape(-1, self.size)
        run_stages(
            *calls, rows, rods, base.geometry, self._work, table, begin, end, size, f0, g, Y, out
        )
        self._calls.raise_failures()
        self.seconds += perf_counter() - start
        self.evaluations += end + 1 - begin
        return end + 1 - begin

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
        start = base.geometry
        end = np.empty_like(start[0]), np.empty_like(start[1]), np.empty_like(start[2])
        displace(start, y[: self._tracers_end], end)
        work = base.work + y[self._tracers_end :] if base.work.size else base.work
        state = State(time, *end, work)
        if self._placing:
            _, loads, _ = self._work
            self._placing.add(state, loads, loads, state.tracer)
        return state

    def diagnose(self, state: State) -> int:
        """Return the first point whose triad is a half-turn from the next one's, or -1."""
        return first_half_turn(state.director, self.scene.rods.tables)


def _groups(scene):
    """Return first node and number of nodes of each rod, then of each node that is of none."""
    rods = scene.rods
    others = np.arange(rods.points, scene.nodes)
    return np.append(rods.first, others), np.append(rods.count, np.ones_like(others))
