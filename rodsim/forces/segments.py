"""Segments of Kirchhoff rods: force and moment inside, (23)-(29), and their balance at points.

Structure of arrays, all rods one after another: X (3, N), D (3, 3, N) with D[i, c, k] the
component c of the director D^(i+1) of point k. Segment k joins point k to the next point of its
rod; the last segment of an open rod does not exist and carries no force and no moment, which is
the boundary condition (44), so open and closed rods share every line below.

The triad of a half point is (29) written without matrices. With c = cos(theta/2), theta the angle
between neighbouring triads, e its axis, V = 1/2 sum_i D^i_k x D^i_(k+1) = sin(theta) e:

    D^i_(k+1/2) = (D^i_k + D^i_(k+1)) / (2 c) - V (V . D^i_k) / (4 c^3 (1 + c))
    (D^j_(k+1) - D^j_k) . D^l_(k+1/2) = V . D^i_k / c = 2 sin(theta/2) e^i    (i, j, l cyclic)

Neither has a small-angle singularity. At a half-turn c = 0 and the principal square root does not
exist: the loads become NaN.

Both steps work on any run of points, so that threads may share them out.
"""

import math

import numpy as np

from rodsim.compiled.constants import HALF_TURN
from rodsim.compiled.flags import ONE, inline, unsigned


@inline
def one_plus_trace(D, k, j):
    """Return 1 + tr A = 4 cos^2(theta/2) for the rotation A from triad k to triad j."""
    total = 1.0
    for i in range(3):
        for c in range(3):
            total += D[i, c, k] * D[i, c, j]
    return total


@inline
def axial(D, k, j):
    """Return V = 1/2 sum_i D^i_k x D^i_j."""
    vx, vy, vz = 0.0, 0.0, 0.0
    for i in range(3):
        vx += D[i, 1, k] * D[i, 2, j] - D[i, 2, k] * D[i, 1, j]
        vy += D[i, 2, k] * D[i, 0, j] - D[i, 0, k] * D[i, 2, j]
        vz += D[i, 0, k] * D[i, 1, j] - D[i, 1, k] * D[i, 0, j]
    return 0.5 * vx, 0.5 * vy, 0.5 * vz


@inline
def half_director(D, k, j, i, c, vx, vy, vz):
    """Return V . D^i_k and the three components of D^i at the half point."""
    along = vx * D[i, 0, k] + vy * D[i, 1, k] + vz * D[i, 2, k]
    mean = 0.5 / c
    turn = along / (4.0 * c * c * c * (1.0 + c))
    return (
        along,
        mean * (D[i, 0, k] + D[i, 0, j]) - turn * vx,
        mean * (D[i, 1, k] + D[i, 1, j]) - turn * vy,
        mean * (D[i, 2, k] + D[i, 2, j]) - turn * vz,
    )


@inline
def _segment_loads(X, D, omega, a, b, rest, ds, k, j, internal):
    """Write F and N of the segment from point k to point j, (23)-(27), into ``internal``."""
    trace = one_plus_trace(D, k, j)
    c = 0.5 * math.sqrt(trace if trace > HALF_TURN else math.nan)
    vx, vy, vz = axial(D, k, j)
    dx, dy, dz = (X[0, j] - X[0, k]) / ds, (X[1, j] - X[1, k]) / ds, (X[2, j] - X[2, k]) / ds
    fx, fy, fz, nx, ny, nz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(3):
        along, hx, hy, hz = half_director(D, k, j, i, c, vx, vy, vz)
        moment = a[i] * (along / (c * ds) - omega[i, k])
        force = b[i] * (hx * dx + hy * dy + hz * dz - (i == 2) - rest[i])
        fx += force * hx
        fy += force * hy
        fz += force * hz
        nx += moment * hx
        ny += moment * hy
        nz += moment * hz
    internal[0, k], internal[1, k], internal[2, k] = fx, fy, fz
    internal[3, k], internal[4, k], internal[5, k] = nx, ny, nz


@inline
def _balance(X, internal, loads, k, before, after):
    """Add g and m of point k, (30) and (31), from the segments on its two sides."""
    for c in range(3):
        p, q = (c + 1) % 3, (c + 2) % 3
        loads[c, k] += internal[c, k] - internal[c, before]
        loads[3 + c, k] += (internal[3 + c, k] - internal[3 + c, before]) + 0.5 * (
            (X[p, after] - X[p, k]) * internal[q, k]
            - (X[q, after] - X[q, k]) * internal[p, k]
            + (X[p, k] - X[p, before]) * internal[q, before]
            - (X[q, k] - X[q, before]) * internal[p, before]
        )


@inline
def _moduli(along, k):
    """Return a, b and the rest strains of segment k, where they vary."""
    return (
        (along[0, k], along[1, k], along[2, k]),
        (along[3, k], along[4, k], along[5, k]),
        (along[6, k], along[7, k], along[8, k]),
    )


def _internal(varying):
    """Make what rods carry inside: with moduli of each segment, or one set for a rod."""

    @unsigned
    def internal_loads(X, D, omega, rods, along, begin, end, internal):
        """Write F and N (6, N) of the segments from the points begin <= k < end on."""
        firsts, counts, closed, spacing, moduli = rods
        for r in range(firsts.size):
            first, ds = np.uint64(firsts[r]), spacing[r]
            a = moduli[0, r], moduli[1, r], moduli[2, r]
            b = moduli[3, r], moduli[4, r], moduli[5, r]
            rest = 0.0, 0.0, 0.0
            last = first + np.uint64(counts[r]) - ONE
            for closing in range(2 if closed[r] else 1):  # one loop to compile, run twice
                low, high, to = first, last, first + ONE
                if closing:
                    low, high, to = last, last + ONE, first
                for k in range(max(low, begin), min(high, end)):
                    if varying:
                        a, b, rest = _moduli(along, k)
                    _segment_loads(X, D, omega, a, b, rest, ds, k, to + (k - low), internal)
            if begin <= last < end and not closed[r]:
                for c in range(6):
                    internal[c, last] = 0.0

    return internal_loads


@unsigned
def balances(X, rods, begin, end, internal, loads):
    """Add g and m of the points begin <= k < end from what is inside of their rods."""
    firsts, counts = rods[0], rods[1]
    for r in range(firsts.size):
        first = np.uint64(firsts[r])
        last = first + np.uint64(counts[r]) - ONE
        for piece in range(3):  # the first point, those between, the last: one loop to compile
            low, high, before, after = first + ONE, last, first, first + ONE + ONE
            if piece == 0:
                low, high, before, after = first, first + ONE, last, first + ONE
            elif piece == 2:
                low, high, before, after = last, last + ONE, last - ONE, first
            for k in range(max(low, begin), min(high, end)):
                _balance(X, internal, loads, k, before + (k - low), after + (k - low))


# Globals, so that compiled functions may call them and still be read from Numba's cache.
uniform_internal, varying_internal = _internal(False), _internal(True)
