"""The fluid around the rods of a stored run: velocity, pressure, paths of tracers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rodsim.analysis.grid import Grid
from rodsim.analysis.replay import Replay
from rodsim.errors import UsageError
from rodsim.fluid import pressure, velocity

FINE = 0.2  # of epsilon: how far a tracer moves in a step at most
MOST_STEPS = 1000  # between two frames


@dataclass(frozen=True)
class Flow:
    """Velocity (n, 3) and pressure (n,) of the fluid at the points of a grid, at one time."""

    time: float
    grid: Grid
    velocity: np.ndarray
    pressure: np.ndarray


def flow_at(replay: Replay, frame: int, grid: Grid) -> Flow:
    """Return the flow that the rods of a frame drive, eqs. (61), (62), at the points of a grid."""
    state, points = replay.state(frame), grid.points
    forces, _ = replay.loads(state)
    epsilon, blob = replay.scene.epsilon, replay.scene.blob
    p = pressure(points, state.position.T, forces, epsilon, blob=blob)
    return Flow(state.time, grid, _field(replay, state)(points), p)


def tracer_paths(replay: Replay, seeds: np.ndarray, first: int, last: int, progress=None):
    """Return the paths (T, P, 3) of tracers that start at ``seeds`` (P, 3) in frame ``first``.

    dx/dt = u(x, t), by the classical Runge-Kutta method of order 4 in equal steps from frame to
    frame, so many that the fastest rod point or tracer moves at most 0.2 epsilon in one. Between
    two frames the rods move as ``Replay.between`` says: the error is that of the frames'
    interval, to its fourth power. One row for each frame from ``first`` to ``last``.
    """
    paths = np.empty((last - first + 1, len(seeds), 3))
    paths[0] = seeds
    for row in range(last - first):
        motion = replay.between(first + row)
        paths[row + 1] = _advance(replay, motion, paths[row])
        if progress:
            progress.update((row + 1) / (last - first), f"t = {motion.end.time:.4g}")
    return paths


def _advance(replay, motion, x):
    """Move tracers (P, 3) from one frame to the next."""
    start, fastest = motion.start.time, _fastest(replay, motion, x)
    steps = int(np.ceil(fastest * motion.size / (FINE * replay.scene.epsilon))) or 1
    if steps > MOST_STEPS:
        raise UsageError(
            f"between t = {start:g} and {motion.end.time:g} the rods move "
            f"{steps * FINE:.3g} epsilon: run with a shorter output.interval"
        )
    h = motion.size / steps
    field = _field(replay, motion.start)
    for n in range(steps):
        middle = _field(replay, motion.at(start + (n + 0.5) * h))
        end = _field(replay, motion.at(start + (n + 1) * h if n + 1 < steps else motion.end.time))
        k1 = field(x)
        k2 = middle(x + 0.5 * h * k1)
        k3 = middle(x + 0.5 * h * k2)
        k4 = end(x + h * k3)
        x = x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        field = end
    return x


def _fastest(replay, motion, x):
    """Return the largest speed of rods and tracers at the two frames of a motion."""
    speeds = [np.abs(motion.increment[: motion.increment.size // 2]).max() / motion.size]
    for state in (motion.start, motion.end):
        speeds.append(np.linalg.norm(_field(replay, state)(x), axis=1).max(initial=0.0))
    return max(speeds)


def _field(replay, state):
    """Return the function x (P, 3) -> u (P, 3) of the flow that a state drives."""
    forces, torques = replay.loads(state)
    sources, scene = state.position.T, replay.scene

    def field(x):
        return velocity(
            x, sources, forces, torques, scene.epsilon, scene.viscosity,
            blob=scene.blob, angular=False,
        )[0]  # fmt: skip

    return field
