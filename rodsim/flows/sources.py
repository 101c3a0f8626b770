"""Which nodes drive the fluid as points: those of rods. Bodies do so by their surfaces."""

import numpy as np

from rodsim.compiled.flags import unsigned


@unsigned
def points_of_rods(rods, position, loads):
    """Return the positions (3, n) and loads (6, n) of the points of rods, the first n nodes."""
    n = rods[0][-1] + rods[1][-1]
    if n == position.shape[1]:
        return position, loads
    return np.ascontiguousarray(position[:, :n]), np.ascontiguousarray(loads[:, :n])
