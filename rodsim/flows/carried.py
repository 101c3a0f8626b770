"""Rods and tracers carried by a background flow, see :mod:`rodsim.flows.background`."""

import numpy as np

from rodsim.compiled.flags import MAT, VEC, kernel
from rodsim.compiled.formula import VARIABLES, compute
from rodsim.compiled.kernels import part

BLOCK = 256  # points at a time: their intermediate values stay in the cache
HEAD = 7  # numbers before the table: whether planar, the lines of u and w


@kernel(f"void({VEC}, float64, {MAT}, {MAT})")
def carry(fixed, t, points, out):
    """Add u_inf, and w_inf where ``out`` has six rows, at points (3, n)."""
    table = fixed[HEAD:].reshape((fixed.size - HEAD) // 5, 5)
    planar = fixed[0] != 0.0
    for begin in range(0, points.shape[1], BLOCK):
        count = min(BLOCK, points.shape[1] - begin)
        work = np.empty((table.shape[0], count))
        for c in range(3):
            for i in range(count):
                work[c, i] = points[c, begin + i]
        work[len(VARIABLES) - 1] = t
        compute(table, work)
        for row in range(out.shape[0]):
            if planar and (row == 0 or row > 3) and out.shape[0] == 6:
                continue  # 0 but for rounding
            line = int(fixed[1 + row])
            for i in range(count):
                out[row, begin + i] += work[line, i]


@part
def carry_rods(row, fixed, rods, state, loads, velocities):
    """Add u_inf and w_inf at the points of the rods."""
    carry(fixed, row[0], state[0], velocities[0])


@part
def carry_tracers(row, fixed, rods, state, loads, velocities):
    """Add u_inf at the tracers."""
    carry(fixed, row[0], state[2], velocities[1])
