"""The loads of elastic rods by threads: for very many points, where fast sums leave little else.

Threads share out runs of points. A run writes what the rods carry inside from its own points on,
and then balances its own points. Formulas are those of :mod:`rodsim.forces.segments`, and so are
the bits, whatever the number of threads.
"""

import numpy as np
from numba import prange

from rodsim.compiled.flags import threaded_kernel
from rodsim.compiled.kernels import part
from rodsim.forces.segments import balances, uniform_internal, varying_internal

RUN = 2048  # points


def _loads(varying):
    """Make the loads of rods: with moduli of their own for each segment, or one set for a rod."""

    @threaded_kernel(fastmath=False)
    def point_loads(X, D, omega, rods, along, loads):
        internal, n = np.empty((6, X.shape[1])), np.uint64(X.shape[1])
        runs = (X.shape[1] + RUN - 1) // RUN
        for run in prange(runs):
            begin = np.uint64(run * RUN)
            end = min(n, begin + np.uint64(RUN))
            if varying:
                varying_internal(X, D, omega, rods, along, begin, end, internal)
            else:
                uniform_internal(X, D, omega, rods, along, begin, end, internal)
        for run in prange(runs):
            begin = np.uint64(run * RUN)
            end = min(n, begin + np.uint64(RUN))
            balances(X, rods, begin, end, internal, loads)

    return point_loads


# Globals, so that parts may call them and still be read from Numba's cache.
_uniform_loads, _varying_loads = _loads(False), _loads(True)


@part
def elastic_loads(row, fixed, rods, state, loads, velocities):
    """The part of elastic rods, see :func:`rodsim.forces.elasticity.elastic_loads`."""
    omega = row.reshape(3, row.size // 3)
    _uniform_loads(state[0], state[1], omega, rods, loads, loads)  # nothing varies along them


@part
def varying_loads(row, fixed, rods, state, loads, velocities):
    """The part of rods whose moduli vary."""
    n = row.size // 3
    _varying_loads(state[0], state[1], row.reshape(3, n), rods, fixed.reshape(9, n), loads)
