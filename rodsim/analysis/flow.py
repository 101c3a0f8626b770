"""The fluid around the rods of a stored run: velocity, pressure, paths of tracers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rodsim.analysis.grid import Grid
from rodsim.analysis.replay import Replay
from rodsim.errors import UsageError

FINE = 0.2  # of epsilon: how far anything moves in a step at most
MOST_STEPS = 10_000  # between two frames


@dataclass(frozen=True)
class Flow:
    """Velocity (n, 3) and pressure (n,) of the fluid at the points of a grid, at one time."""

    time: float
    grid: Grid
    velocity: np.ndarray
    pressure: np.ndarray


def flow_at(replay: Replay, frame: int, grid: Grid, raw=False) -> Flow:
    """Return the flow that the rods of a frame drive, eqs. (61), (62), at the points of a grid.

    NaN below a wall.

    ``raw``: by the loads of the stored state as it is, see :meth:`Replay.settled_sources`.
    """
    sources = replay.sources(frame) if raw else replay.settled_sources(frame)
    points = grid.points
    time = float(replay.run.time[frame])
    return Flow(time, grid, sources.velocity(points), sources.pressure(points))


@dataclass(frozen=True)
class Paths:
    """Paths (T, P, 3) of tracers over the frames at time (T,), and how far they can be trusted.

    ``miss`` (T - 1,): the rods' own points, followed in the same way from each frame to the next,
    miss the places where the file has them by so much at most, length.
    """

    time: np.ndarray
    position: np.ndarray
    miss: np.ndarray


def tracer_paths(replay: Replay, seeds, first: int, last: int, progress=None) -> Paths:
    """Return the paths of tracers that start at ``seeds`` (P, 3) in frame ``first``.

    dx/dt = u(x, t), by the classical Runge-Kutta method of order 4 in equal steps from frame to
    frame, so many that nothing moves by more than 0.2 epsilon in one. Between two frames the
    places of the rods' points and their forces and torques change linearly, an error of second
    order in the interval of the frames. (States in between, and their loads, would do worse: a
    rod is so stiff that what is left of the frames' own error becomes a large force.) What comes
    below a wall goes on as NaN.
    """
    position, miss = np.empty((last - first + 1, len(seeds), 3)), np.empty(last - first)
    position[0] = seeds
    after = replay.settled_sources(first)
    for row in range(last - first):
        before, after = after, replay.settled_sources(first + row + 1)
        begin, end = replay.run.time[first + row : first + row + 2]
        moved = _advance(before, after, begin, end, np.vstack([position[row], before.points]))
        moved[moved[:, 2] < replay.scene.floor] = np.nan
        position[row + 1] = moved[: len(seeds)]
        missed = np.abs(moved[len(seeds) :] - after.points).max()
        miss[row] = np.inf if np.isnan(missed) else missed
        if progress:
            progress.update((row + 1) / (last - first), f"t = {end:.4g}")
    return Paths(replay.run.time[first : last + 1], position, miss)


def _advance(before, after, begin, end, x):
    """Move points (n, 3) from one frame to the next."""
    steps = _steps(before, after, begin, end, x)
    h, now = (end - begin) / steps, before
    for n in range(steps):
        middle = before.towards(after, (n + 0.5) / steps)
        then = before.towards(after, (n + 1) / steps)
        k1 = now.velocity(x)
        k2 = middle.velocity(x + 0.5 * h * k1)
        k3 = middle.velocity(x + 0.5 * h * k2)
        k4 = then.velocity(x + h * k3)
        x = x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        now = then
    return x


def _steps(before, after, begin, end, x):
    """Return the number of steps between two frames, from the fastest point in both."""
    speeds = [np.linalg.norm(s.velocity(x), axis=1) for s in (before, after)]
    fastest = np.nanmax(speeds)
    steps = fastest * (end - begin) / (FINE * before.scene.epsilon)
    if not steps < MOST_STEPS:
        raise UsageError(
            f"between t = {begin:g} and {end:g} points move at {fastest:.3g}, {steps * FINE:.3g} "
            "epsilon from frame to frame: run with a shorter output.interval"
        )
    return max(1, int(np.ceil(steps)))
