"""The exact gradient of the rod's energy, beside the paper's loads.

The moments of (24)-(26) are not quite those of the energy (6): the triads of half points turn with
both neighbours. With S = sin(phi/2) e = V/(2 c), phi the angle between neighbouring triads, e its
axis, c = cos(phi/2), and T = (X_(k+1) - X_k) x F, the moment whose balance (31) is exactly
-dE/dtheta is

    N* = N - S (S . N)/(2 q) + (T x S)/(4 q),    q = cos^2(phi/4) = (1 + c)/2.

It differs from N by phi^2/8 of N and phi/8 of T. Forces (30) are exact as they are, and what is
added to one point is taken from the next, so net force and torque stay zero. Runs keep the loads of
the paper; descents and symmetric Hessians need these.
"""

import math

import numpy as np

from rodsim.compiled.constants import HALF_TURN
from rodsim.compiled.flags import inline, unsigned
from rodsim.compiled.kernels import part
from rodsim.forces.elasticity import (
    _axial,
    _moduli,
    _one_plus_trace,
    _segment_loads,
    _uniform_loads,
    _varying_loads,
)


@inline
def _difference(X, D, internal, k, j):
    """Return N* - N of the segment from point k to point j, its F and N in ``internal``."""
    trace = _one_plus_trace(D, k, j)
    c = 0.5 * math.sqrt(trace if trace > HALF_TURN else math.nan)
    vx, vy, vz = _axial(D, k, j)
    sx, sy, sz = 0.5 * vx / c, 0.5 * vy / c, 0.5 * vz / c
    q = 0.5 * (1.0 + c)
    dx, dy, dz = X[0, j] - X[0, k], X[1, j] - X[1, k], X[2, j] - X[2, k]
    fx, fy, fz = internal[0, k], internal[1, k], internal[2, k]
    tx, ty, tz = dy * fz - dz * fy, dz * fx - dx * fz, dx * fy - dy * fx
    along = (sx * internal[3, k] + sy * internal[4, k] + sz * internal[5, k]) / (2.0 * q)
    return (
        (ty * sz - tz * sy) / (4.0 * q) - along * sx,
        (tz * sx - tx * sz) / (4.0 * q) - along * sy,
        (tx * sy - ty * sx) / (4.0 * q) - along * sz,
    )


def _correction(varying):
    """Make the function that adds N* - N of every segment to the torques of its ends."""

    @unsigned
    def correct(X, D, omega, rods, along, loads):
        internal = np.empty((6, X.shape[1]))
        firsts, counts, closed, spacing, moduli = rods
        for r in range(firsts.size):
            first, end = firsts[r], firsts[r] + counts[r]
            a = moduli[0, r], moduli[1, r], moduli[2, r]
            b = moduli[3, r], moduli[4, r], moduli[5, r]
            rest = 0.0, 0.0, 0.0
            for k in range(first, end if closed[r] else end - 1):
                j = k + 1 if k + 1 < end else first
                if varying:
                    a, b, rest = _moduli(along, k)
                _segment_loads(X, D, omega, a, b, rest, spacing[r], k, j, internal)
                extra = _difference(X, D, internal, k, j)
                for c in range(3):
                    loads[3 + c, k] += extra[c]
                    loads[3 + c, j] -= extra[c]

    return correct


# Globals, so that compiled functions may call them and still be read from Numba's cache.
_correct_uniform, _correct_varying = _correction(False), _correction(True)


@part
def exact_elastic_loads(row, fixed, rods, state, loads, velocities):
    """The exact gradient of what :func:`rodsim.forces.elasticity.elastic_loads` is the load of."""
    n = state[0].shape[1]
    omega, none = row.reshape(3, n), fixed.reshape(0, 0)
    _uniform_loads(state[0], state[1], omega, rods, none, loads)
    _correct_uniform(state[0], state[1], omega, rods, none, loads)


@part
def exact_varying_loads(row, fixed, rods, state, loads, velocities):
    """The exact gradient of what :func:`rodsim.forces.elasticity.varying_loads` is the load of."""
    n = state[0].shape[1]
    omega, along = row.reshape(3, n), fixed.reshape(9, n)
    _varying_loads(state[0], state[1], omega, rods, along, loads)
    _correct_varying(state[0], state[1], omega, rods, along, loads)
