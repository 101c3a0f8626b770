"""The parts of the fluid where its sums are on a card: they call a sum by its address.

``fixed`` is (address, epsilon, viscosity, height of the wall), without a wall -inf.
"""

import numpy as np

from rodsim.compiled.flags import call_sum
from rodsim.compiled.kernels import part
from rodsim.flows.sources import points_of_rods
from rodsim.flows.wall import drop_below, touches


@part
def move_rods(row, fixed, rods, state, loads, velocities):
    """Add u and w at the rods."""
    points, out = state[0], velocities[0]
    epsilon, viscosity, height = fixed[1], fixed[2], fixed[3]
    if touches(points, height):
        out[:] = np.nan  # no fluid there: the step is rejected
    else:
        call_sum(int(fixed[0]), points, points, loads, epsilon, viscosity, height, out)


@part
def move_tracers(row, fixed, rods, state, loads, velocities):
    """Add u at the tracers."""
    points, out = state[2], velocities[1]
    epsilon, viscosity, height = fixed[1], fixed[2], fixed[3]
    sources, theirs = points_of_rods(rods, state[0], loads)
    call_sum(int(fixed[0]), points, sources, theirs, epsilon, viscosity, height, out)
    drop_below(points, height, epsilon, out)
