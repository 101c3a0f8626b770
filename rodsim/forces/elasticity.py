"""The Kirchhoff rod: strains, point loads (23)-(31) and energies (6). Arrays only.

Structure of arrays, all rods one after another: X (3, N), D (3, 3, N) with D[i, c, k] the
component c of the director D^(i+1) of point k. Segment k joins point k to the next point of its
rod; the last segment of an open rod does not exist and carries no force and no moment, which is
the boundary condition (44), so open and closed rods share every line below.

The triad of a half point is (29) written without matrices. With c = cos(theta/2), theta the angle
between neighbouring triads, e its axis, V = 1/2 sum_i D^i_k x D^i_(k+1) = sin(theta) e:

    D^i_(k+1/2) = (D^i_k + D^i_(k+1)) / (2 c) - V (V . D^i_k) / (4 c^3 (1 + c))
    (D^j_(k+1) - D^j_k) . D^l_(k+1/2) = V . D^i_k / c = 2 sin(theta/2) e^i    (i, j, l cyclic)

Neither has a small-angle singularity. At a half-turn c = 0 and the principal square root does not
exist: the loads become NaN, and ``first_half_turn`` says where.

``rods`` is ``nodes.Rods.tables``: first, count, closed, spacing (R,) and moduli (6, R).
"""

import math

import numpy as np

from rodsim.compiled.constants import HALF_TURN
from rodsim.compiled.flags import MAT, ONE, RODS, TRIADS, VEC, inline, kernel, unsigned
from rodsim.compiled.kernels import part


@inline
def _one_plus_trace(D, k, j):
    """Return 1 + tr A = 4 cos^2(theta/2) for the rotation A from triad k to triad j."""
    total = 1.0
    for i in range(3):
        for c in range(3):
            total += D[i, c, k] * D[i, c, j]
    return total


@inline
def _axial(D, k, j):
    """Return V = 1/2 sum_i D^i_k x D^i_j."""
    vx, vy, vz = 0.0, 0.0, 0.0
    for i in range(3):
        vx += D[i, 1, k] * D[i, 2, j] - D[i, 2, k] * D[i, 1, j]
        vy += D[i, 2, k] * D[i, 0, j] - D[i, 0, k] * D[i, 2, j]
        vz += D[i, 0, k] * D[i, 1, j] - D[i, 1, k] * D[i, 0, j]
    return 0.5 * vx, 0.5 * vy, 0.5 * vz


@inline
def _half_director(D, k, j, i, c, vx, vy, vz):
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
    trace = _one_plus_trace(D, k, j)
    c = 0.5 * math.sqrt(trace if trace > HALF_TURN else math.nan)
    vx, vy, vz = _axial(D, k, j)
    dx, dy, dz = (X[0, j] - X[0, k]) / ds, (X[1, j] - X[1, k]) / ds, (X[2, j] - X[2, k]) / ds
    fx, fy, fz, nx, ny, nz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(3):
        along, hx, hy, hz = _half_director(D, k, j, i, c, vx, vy, vz)
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


def _loads(varying):
    """Make the loads of rods: with moduli of their own for each segment, or one set for a rod."""

    @unsigned
    def point_loads(X, D, omega, rods, along, loads):
        internal = np.empty((6, X.shape[1]))  # F in rows 0-2 and N in rows 3-5 of each segment
        firsts, counts, closed, spacing, moduli = rods
        for r in range(firsts.size):
            first, ds = np.uint64(firsts[r]), spacing[r]
            a = moduli[0, r], moduli[1, r], moduli[2, r]
            b = moduli[3, r], moduli[4, r], moduli[5, r]
            rest = 0.0, 0.0, 0.0
            last = first + np.uint64(counts[r]) - ONE
            for k in range(first, last):
                if varying:
                    a, b, rest = _moduli(along, k)
                _segment_loads(X, D, omega, a, b, rest, ds, k, k + ONE, internal)
            if closed[r]:
                if varying:
                    a, b, rest = _moduli(along, last)
                _segment_loads(X, D, omega, a, b, rest, ds, last, first, internal)
            else:
                for c in range(6):
                    internal[c, last] = 0.0
            _balance(X, internal, loads, first, last, first + ONE)
            for k in range(first + ONE, last):
                _balance(X, internal, loads, k, k - ONE, k + ONE)
            _balance(X, internal, loads, last, last - ONE, first)

    return point_loads


# Globals, so that compiled functions may call them and still be read from Numba's cache.
_uniform_loads, _varying_loads = _loads(False), _loads(True)
UNIFORM = np.zeros((0, 0))


def point_loads(X, D, omega, rods, loads, along=UNIFORM):
    """Add the point forces and torques of the rods on the fluid, g_k = -f_k ds, m_k = -n_k ds.

    F^i = b_i (D^i . X' - delta_3i)                                                  (23)
    N^i = a_i (D^j' . D^l - Omega_i)                                                 (24)-(26)
    g_k = F_(k+1/2) - F_(k-1/2)                                                      (30)
    m_k = N_(k+1/2) - N_(k-1/2) + 1/2 (dX x F)_(k+1/2) + 1/2 (dX x F)_(k-1/2)        (31)

    omega (3, N): strain twist at the middle of each segment; loads (6, N): g, then m. along (9, N):
    where moduli vary along the rods, a, b, and the strains of (23) at rest, of each segment.
    """
    (_varying_loads if along.size else _uniform_loads)(X, D, omega, rods, along, loads)


@part
def elastic_loads(row, fixed, rods, state, loads, velocities):
    """The part of elastic rods: ``row`` is the strain twist, see :func:`point_loads`."""
    omega = row.reshape(3, row.size // 3)
    _uniform_loads(state[0], state[1], omega, rods, fixed.reshape(0, 0), loads)


@part
def varying_loads(row, fixed, rods, state, loads, velocities):
    """The part of rods whose moduli vary: ``fixed`` has them, see :func:`point_loads`."""
    n = row.size // 3
    _varying_loads(state[0], state[1], row.reshape(3, n), rods, fixed.reshape(9, n), loads)


@unsigned
def segment_strain(X, D, k, j, ds, strain, half):
    """Strains of the segment from point k to point j, and the triad of its half point.

    strain (6,): (D^j' . D^l)_i for i = 1, 2, 3 (1/length), then D^i . X' - delta_3i; half (3, 3):
    half[i] = D^(i+1)_(k+1/2). NaN at a half-turn.
    """
    trace = _one_plus_trace(D, k, j)
    c = 0.5 * math.sqrt(trace if trace > HALF_TURN else math.nan)
    vx, vy, vz = _axial(D, k, j)
    for i in range(3):
        along, half[i, 0], half[i, 1], half[i, 2] = _half_director(D, k, j, i, c, vx, vy, vz)
        strain[i] = along / (c * ds)
        strain[3 + i] = -1.0 if i == 2 else 0.0
        for axis in range(3):
            strain[3 + i] += half[i, axis] * (X[axis, j] - X[axis, k]) / ds


@kernel(f"void({MAT}, {TRIADS}, {MAT}, {RODS}, {MAT}, {MAT}, {VEC})")
def energies(X, D, omega, rods, along, out, length):
    """Elastic energy (6) of each rod, split, and its present length; ``along`` as for the loads.

    out (4, R): bending (i = 1, 2), twisting (i = 3), shear (i = 1, 2), stretch (i = 3), each
    1/2 ds sum_k modulus * strain^2 over the segments; length (R,): sum_k |X_(k+1) - X_k|.
    """
    first, count, closed, spacing, moduli = rods
    strain = np.empty(6)
    half = np.empty((3, 3))
    for r in range(first.size):
        begin, end = first[r], first[r] + count[r]
        out[:, r] = 0.0
        length[r] = 0.0
        for k in range(begin, end if closed[r] else end - 1):
            j = k + 1 if k + 1 < end else begin
            segment_strain(X, D, k, j, spacing[r], strain, half)
            for i in range(3):
                strain[i] -= omega[i, k]
                if along.size:
                    strain[3 + i] -= along[6 + i, k]
            for i in range(6):
                kind = (i // 3) * 2 + (1 if i % 3 == 2 else 0)
                modulus = along[i, k] if along.size else moduli[i, r]
                out[kind, r] += 0.5 * spacing[r] * modulus * strain[i] ** 2
            length[r] += math.sqrt(
                (X[0, j] - X[0, k]) ** 2 + (X[1, j] - X[1, k]) ** 2 + (X[2, j] - X[2, k]) ** 2
            )


@unsigned
def first_half_turn(D, rods):
    """Return the first point whose triad is a half-turn away from the next one's, or -1."""
    first, count, closed, _, _ = rods
    for r in range(first.size):
        begin, end = first[r], first[r] + count[r]
        for k in range(begin, end if closed[r] else end - 1):
            if not _one_plus_trace(D, k, k + 1 if k + 1 < end else begin) > HALF_TURN:
                return k
    return -1
