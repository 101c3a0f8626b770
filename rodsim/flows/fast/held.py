"""Points that are held, as ends of rods on bodies: there the sums are exact.

What holds a point loads it in turn, which all others feel by exact sums: were it moved by the fast
one, the mobility of what is free would be symmetric to its accuracy only.
"""

import numpy as np

from rodsim.compiled.flags import call_sum, unsigned
from rodsim.flows.fast.packed import EPSILON, HELD, RUN, SUM, VISCOSITY, WALL, integers


@unsigned
def velocities_of_held(fixed, velocities):
    """Return u and w (6, H) of the held points."""
    held = integers(fixed, HELD)
    found = np.empty((6, held.size))
    for k in range(held.size):
        for c in range(6):
            found[c, k] = velocities[c, held[k]]
    return found


@unsigned
def move_held(fixed, points, loads, before, velocities):
    """Set u and w of the held points to those ``before`` and the exact sums."""
    held = integers(fixed, HELD)
    if held.size == 0:
        return
    places = np.empty((3, held.size))
    for k in range(held.size):
        for c in range(3):
            places[c, k] = points[c, held[k]]
    epsilon, viscosity, wall = fixed[EPSILON], fixed[VISCOSITY], fixed[WALL]
    address, run = int(fixed[SUM]), int(fixed[RUN])
    call_sum(address, run, places, points, loads, epsilon, viscosity, wall, before)
    for k in range(held.size):
        for c in range(6):
            velocities[c, held[k]] = before[c, k]
