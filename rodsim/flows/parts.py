"""The parts of the fluid: they call a sum by its address, whatever it is and whoever computes it.

``fixed`` is (sum, run, epsilon, viscosity, height of the wall), two addresses first; -inf without
a wall.
"""

import math

import numpy as np

from rodsim.compiled.constants import ON_WALL
from rodsim.compiled.flags import call_sum, unsigned
from rodsim.compiled.kernels import part
from rodsim.flows.sources import points_of_rods


@unsigned
def touches(points, wall):
    """Return whether any of the points (3, N) is at the wall or below it."""
    lowest = math.inf
    for k in range(points.shape[1]):
        lowest = min(lowest, points[2, k])
    return lowest <= wall


@unsigned
def drop_below(points, wall, epsilon, out):
    """Set velocities (3, T) of points below the wall to NaN: they are nowhere."""
    for i in range(points.shape[1]):
        if points[2, i] < wall - ON_WALL * epsilon:
            for c in range(out.shape[0]):
                out[c, i] = np.nan


@unsigned
def _add(fixed, targets, sources, loads, out):
    address, run = int(fixed[0]), int(fixed[1])
    call_sum(address, run, targets, sources, loads, fixed[2], fixed[3], fixed[4], out)


@part
def move_rods(row, fixed, rods, state, loads, velocities):
    """Add u and w at the rods."""
    points, out = state[0], velocities[0]
    if touches(points, fixed[4]):
        out[:] = np.nan  # no fluid there: the step is rejected
    else:
        _add(fixed, points, points, loads, out)


@part
def move_tracers(row, fixed, rods, state, loads, velocities):
    """Add u at the tracers."""
    points, out = state[2], velocities[1]
    sources, theirs = points_of_rods(rods, state[0], loads)
    _add(fixed, points, sources, theirs, out)
    drop_below(points, fixed[4], fixed[2], out)
