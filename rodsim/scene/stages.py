"""What is done with evaluations, each one compiled call: one, a product with J, a step.

All call the one evaluation by its address ``velocities``, so that it is compiled only once.
"""

import numpy as np

from rodsim.compiled.flags import (
    INTS,
    MAT,
    RODS,
    STATE,
    VEC,
    WORK,
    call_evaluation,
    inline,
    kernel,
)
from rodsim.compiled.passes import image, probe, remaining, weighted_sum
from rodsim.scene.loop import CALLS, to_increments

SCENE = f"int64, {CALLS}, {VEC}, {RODS}, {STATE}, {WORK}"  # as the evaluation takes it


@inline
def _rates(velocities, table, numbers, driven, rods, base, work, y, out):
    """Write dy/dt at increments ``y`` from ``base`` into ``out``."""
    call_evaluation(velocities, table, numbers, driven, rods, base, work, y, out)
    end = 6 * work[1].shape[1]
    to_increments(y[:end], out[:end])


@kernel(f"void({SCENE}, {VEC}, {VEC}, boolean)")
def evaluate_at(velocities, table, numbers, driven, rods, base, work, y, out, rates):
    """Write the velocities at increments ``y`` from ``base`` into ``out``, or dy/dt."""
    if rates:
        _rates(velocities, table, numbers, driven, rods, base, work, y, out)
    else:
        call_evaluation(velocities, table, numbers, driven, rods, base, work, y, out)


@kernel(f"void({SCENE}, float64, {VEC}, {VEC}, {VEC}, {MAT}, {VEC})")
def product(
    velocities, table, numbers, driven, rods, base, work, size, direction, rate, weights, room, out
):
    """out = J v in the scaled norm, by a difference over ``size`` along v = ``direction``.

    rate : dy/dt at ``base``. room : two vectors like y, the first zero beyond ``weights``.
    """
    y, shifted = room[0], room[1]
    probe(size, direction, weights, y)
    _rates(velocities, table, numbers, driven, rods, base, work, y, shifted)
    image(size, shifted, rate, weights, out)


@inline
def _first(mu_tilde, f0, g, Y):
    """Y_1 = h mu~_1 (F_0 + g), after Y_0 = 0."""
    for i in range(np.uint64(f0.size)):
        Y[0, i] = 0.0
        Y[1, i] = mu_tilde * (f0[i] + g[i])


@inline
def _combine(row, size, y, oldest, f, f0, g):
    """Write Y_j, see below, over Y_(j-2)."""
    mu, nu, mu_tilde, gamma_tilde = row[0], row[1], size * row[2], size * row[3]
    for i in range(np.uint64(y.size)):
        rates = mu_tilde * (f[i] + g[i]) + gamma_tilde * (f0[i] + g[i])
        oldest[i] = mu * y[i] + nu * oldest[i] + rates


@kernel(
    f"float64(int64, {CALLS}, {MAT}, {RODS}, {STATE}, {WORK}, {MAT}, int64, int64, float64, {VEC}, "
    f"float64, float64, float64, {VEC}, float64, {VEC}, {VEC}, {INTS}, {INTS}, {MAT})"
)
def take_step(
    velocities, table, numbers, driven, rods, base, work,
    coefficients, begin, count, size, f0,
    c, memory, factor, third, trend, before,
    weights, first, points, room,
):  # fmt: skip
    """Take a step of s stages by a three-term recurrence, with g added to all rates F,

        Y_0 = 0,    Y_1 = h mu~_1 (F_0 + g),
        Y_j = mu_j Y_(j-1) + nu_j Y_(j-2) + h (mu~_j (F_(j-1) + g) + gamma~_j (F_0 + g)),

    with the four coefficients in row j of ``coefficients`` (s + 1, 5). Return how large the error
    is that it leaves, as ``passes.remaining`` does.

    g = factor third + trend before, from y''' of steps behind. Increments are those from the state
    ``base``; at the end the state in ``work`` is that of Y_s. A call makes ``count`` evaluations,
    from that at Y_(begin-1) on: s in all but for a driven scene, whose rows may come in blocks.
    driven: the driven rows of these evaluations in turn, or one that stands for all.

    room (7, n) : Y_(s mod 2) is in the row of that number; then come the velocities at Y_s and the
    rates there, y''', and g.
    """
    Y, f, f1, left, g, error = room[:2], room[2], room[3], room[4], room[5], room[6]
    s = coefficients.shape[0] - 1
    if begin == 2:
        weighted_sum(factor, third, trend, before, g)
        _first(size * coefficients[1, 2], f0, g, Y)
    for j in range(begin, min(begin + count, s + 1)):
        y = Y[(j - 1) % 2]
        now = driven[j - begin if driven.shape[0] > 1 else 0]
        _rates(velocities, table, numbers, now, rods, base, work, y, f)
        _combine(coefficients[j], size, y, Y[j % 2], f, f0, g)
    if begin + count <= s + 1:
        return 0.0
    now, y = driven[driven.shape[0] - 1], Y[s % 2]
    call_evaluation(velocities, table, numbers, now, rods, base, work, y, f)
    return remaining(size, c, memory, y, f, f0, g, weights, first, points, f1, left, error)
