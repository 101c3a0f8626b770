"""The Kirchhoff rod: point loads (23)-(31), strains and energies (6). Arrays only.

The arrays and the formulas of a segment are those of :mod:`rodsim.forces.segments`. At a half-turn
between neighbouring triads the loads are NaN, and ``first_half_turn`` says where.

``rods`` is ``nodes.Rods.tables``: first, count, closed, spacing (R,) and moduli (6, R).
"""

import math

import numpy as np

from rodsim.compiled.constants import HALF_TURN
from rodsim.compiled.flags import MAT, RODS, TRIADS, VEC, inline, kernel, unsigned
from rodsim.compiled.kernels import part
from rodsim.forces.segments import (
    axial,
    balances,
    half_director,
    one_plus_trace,
    uniform_internal,
    varying_internal,
)


def _loads(varying):
    """Make the loads of rods, one after another."""

    @inline
    def point_loads(X, D, omega, rods, along, loads):
        internal, end = np.empty((6, X.shape[1])), np.uint64(X.shape[1])
        if varying:
            varying_internal(X, D, omega, rods, along, np.uint64(0), end, internal)
        else:
            uniform_internal(X, D, omega, rods, along, np.uint64(0), end, internal)
        balances(X, rods, np.uint64(0), end, internal, loads)

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
    _uniform_loads(state[0], state[1], omega, rods, loads, loads)  # nothing varies along them


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
    trace = one_plus_trace(D, k, j)
    c = 0.5 * math.sqrt(trace if trace > HALF_TURN else math.nan)
    vx, vy, vz = axial(D, k, j)
    for i in range(3):
        along, half[i, 0], half[i, 1], half[i, 2] = half_director(D, k, j, i, c, vx, vy, vz)
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
            if not one_plus_trace(D, k, k + 1 if k + 1 < end else begin) > HALF_TURN:
                return k
    return -1
