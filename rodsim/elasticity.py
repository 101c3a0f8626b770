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
"""

import math

import numpy as np

from rodsim.jit import BOOLS, INTS, MAT, TRIADS, VEC, inline, kernel

ENERGIES = ("bending_energy", "twisting_energy", "shear_energy", "stretch_energy")
RODS = f"{INTS}, {INTS}, {BOOLS}, {VEC}, {MAT}"


@inline
def _cosine_squared(D, k, j):
    """Return cos^2(theta/2) of the rotation from triad k to triad j: (1 + tr A)/4."""
    trace = 0.0
    for i in range(3):
        for c in range(3):
            trace += D[i, c, k] * D[i, c, j]
    return 0.25 * (1.0 + trace)


@inline
def _axial(D, k, j):
    """Return V = 1/2 sum_i D^i_k x D^i_j."""
    vx, vy, vz = 0.0, 0.0, 0.0
    for i in range(3):
        vx += D[i, 1, k] * D[i, 2, j] - D[i, 2, k] * D[i, 1, j]
        vy += D[i, 2, k] * D[i, 0, j] - D[i, 0, k] * D[i, 2, j]
        vz += D[i, 0, k] * D[i, 1, j] - D[i, 1, k] * D[i, 0, j]
    return 0.5 * vx, 0.5 * vy, 0.5 * vz


@kernel(f"void({MAT}, {TRIADS}, int64, int64, float64, {VEC}, {MAT})")
def segment_strain(X, D, k, j, ds, strain, half):
    """Strains of the segment from point k to point j.

    strain (6,): (D^j' . D^l)_i for i = 1, 2, 3 (1/length), then D^i . X' - delta_3i; half (3, 3):
    the triad of the half point, half[i] = D^(i+1)_(k+1/2). NaN at a half-turn.
    """
    c = math.sqrt(max(_cosine_squared(D, k, j), 0.0))
    if c < 1e-7:  # 1 + tr A has lost every digit: no direction is left
        c = math.nan
    vx, vy, vz = _axial(D, k, j)
    correction = 1.0 / (4.0 * c * c * c * (1.0 + c))
    for i in range(3):
        along = vx * D[i, 0, k] + vy * D[i, 1, k] + vz * D[i, 2, k]
        strain[i] = along / (c * ds)
        half[i, 0] = (D[i, 0, k] + D[i, 0, j]) / (2.0 * c) - vx * along * correction
        half[i, 1] = (D[i, 1, k] + D[i, 1, j]) / (2.0 * c) - vy * along * correction
        half[i, 2] = (D[i, 2, k] + D[i, 2, j]) / (2.0 * c) - vz * along * correction
        strain[3 + i] = (
            half[i, 0] * (X[0, j] - X[0, k])
            + half[i, 1] * (X[1, j] - X[1, k])
            + half[i, 2] * (X[2, j] - X[2, k])
        ) / ds
    strain[5] -= 1.0


@kernel(f"void({MAT}, {TRIADS}, {MAT}, {RODS}, {MAT}, {MAT})")
def point_loads(X, D, omega, first, count, closed, spacing, moduli, internal, loads):
    """Point forces and torques of the rods on the fluid, g_k = -f_k ds and m_k = -n_k ds.

    F^i = b_i (D^i . X' - delta_3i)                                                  (23)
    N^i = a_i (D^j' . D^l - Omega_i)                                                 (24)-(26)
    g_k = F_(k+1/2) - F_(k-1/2)                                                      (30)
    m_k = N_(k+1/2) - N_(k-1/2) + 1/2 (dX x F)_(k+1/2) + 1/2 (dX x F)_(k-1/2)        (31)

    omega (3, N): strain twist at the middle of each segment; moduli (6, R): a_1 a_2 a_3 b_1 b_2
    b_3; internal (6, N): scratch, F in rows 0-2 and N in rows 3-5 of each segment on return;
    loads (6, N): g, then m.
    """
    strain = np.empty(6)
    half = np.empty((3, 3))
    for r in range(first.size):
        begin, end = first[r], first[r] + count[r]
        last = end if closed[r] else end - 1
        for k in range(begin, last):
            segment_strain(X, D, k, k + 1 if k + 1 < end else begin, spacing[r], strain, half)
            for c in range(3):
                force, moment = 0.0, 0.0
                for i in range(3):
                    moment += moduli[i, r] * (strain[i] - omega[i, k]) * half[i, c]
                    force += moduli[3 + i, r] * strain[3 + i] * half[i, c]
                internal[c, k] = force
                internal[3 + c, k] = moment
        for k in range(last, end):
            internal[:, k] = 0.0
        for k in range(begin, end):
            before = k - 1 if k > begin else end - 1
            after = k + 1 if k + 1 < end else begin
            for c in range(6):
                loads[c, k] = internal[c, k] - internal[c, before]
            for c in range(3):
                p, q = (c + 1) % 3, (c + 2) % 3
                loads[3 + c, k] += 0.5 * (
                    (X[p, after] - X[p, k]) * internal[q, k]
                    - (X[q, after] - X[q, k]) * internal[p, k]
                    + (X[p, k] - X[p, before]) * internal[q, before]
                    - (X[q, k] - X[q, before]) * internal[p, before]
                )


@kernel(f"void({MAT}, {TRIADS}, {MAT}, {RODS}, {MAT}, {VEC})")
def energies(X, D, omega, first, count, closed, spacing, moduli, out, length):
    """Elastic energy (6) of each rod, split, and its present length.

    out (4, R): bending (i = 1, 2), twisting (i = 3), shear (i = 1, 2), stretch (i = 3), each
    1/2 ds sum_k modulus * strain^2 over the segments; length (R,): sum_k |X_(k+1) - X_k|.
    """
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
            for i in range(6):
                kind = (i // 3) * 2 + (1 if i % 3 == 2 else 0)
                out[kind, r] += 0.5 * spacing[r] * moduli[i, r] * strain[i] ** 2
            length[r] += math.sqrt(
                (X[0, j] - X[0, k]) ** 2 + (X[1, j] - X[1, k]) ** 2 + (X[2, j] - X[2, k]) ** 2
            )


@kernel(f"int64({TRIADS}, {INTS}, {INTS}, {BOOLS})")
def first_half_turn(D, first, count, closed):
    """Return the first point whose triad is a half-turn away from the next one's, or -1."""
    for r in range(first.size):
        begin, end = first[r], first[r] + count[r]
        for k in range(begin, end if closed[r] else end - 1):
            if _cosine_squared(D, k, k + 1 if k + 1 < end else begin) < 1e-14:
                return k
    return -1
