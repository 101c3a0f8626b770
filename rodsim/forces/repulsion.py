"""Contact: rods push each other, themselves and a wall apart. Arrays only.

A smooth double line integral over the points of the rods that are nearer to each other than a
diameter d, and no neighbours along a rod:

    E   = sum over pairs A ds_i ds_j (1 - r^2/d^2)^3,    A = C a/d^3
    g_i = 6 A ds_i ds_j/d^2 (1 - r^2/d^2)^2 (X_i - X_j) = -g_j,    no torque

with r = |X_i - X_j|, ds half at the two ends of an open rod, a the largest bending modulus of the
rod, of two rods the smaller one, C the strength. The energy has two continuous derivatives and
every force is bounded, so an explicit method with error control follows it. Straight parallel lines
at a distance h push each other with (32/35) 7 A (h/d) q^(5/2) per length, lines that cross at an
angle alpha with 2 pi A h q^3/sin(alpha), q = 1 - h^2/d^2. Potentials of this kind between
filaments: Maxian & Donev (2024, arXiv:2408.15913).

A wall counts as a rod's surface: the centreline touches it at d/2. A rod near it is pushed as by
its own mirror image, parallel to it: with z the height of a point and q = 1 - (2 z/d)^2,

    E = sum (16/35) A d ds_i q^(7/2),    g_z = (64/5) A ds_i (z/d) q^(5/2)

``fixed`` of the pairs: d, of each rod C a/d^3 and the number of segments excluded, of each point
ds. Of the wall: its height, d, of each point A ds.
"""

import math

import numpy as np

from rodsim.compiled.flags import MAT, RODS, VEC, kernel, unsigned
from rodsim.compiled.kernels import part
from rodsim.forces.spheres import BLOCK, ROD, blocks_of, distance2, near_blocks, points_within


@unsigned
def _numbers(fixed, rods):
    """Return d, A (R,), which points count (see ``points_within``), ds (N,)."""
    n = rods[0].size
    counting = rods[1], rods[2], fixed[1 + n : 1 + 2 * n].astype(np.int64)
    return fixed[0], fixed[1 : 1 + n], counting, fixed[1 + 2 * n :]


@unsigned
def _near(X, rods, reach):
    """Return the blocks of all rods, pairs of them that may be near, and room for their points."""
    table, radius = blocks_of(X, rods[0], rods[1])
    pairs = near_blocks(X, table, radius, reach)
    return table, radius, pairs, np.empty((BLOCK * BLOCK, 2), dtype=np.uint64)


@part
def push_apart(row, fixed, rods, state, loads, velocities):
    """Add the force between all points that are nearer to each other than d."""
    X = state[0]
    d, strength, counting, ds = _numbers(fixed, rods)
    table, radius, pairs, near = _near(X, rods, d)
    over_d2 = 1.0 / (d * d)
    for p in range(pairs.shape[0]):
        a, b = pairs[p, 0], pairs[p, 1]
        stiffness = 6.0 * min(strength[table[a, ROD]], strength[table[b, ROD]]) * over_d2
        for m in range(points_within(X, table, radius, a, b, counting, d, near)):
            i, j = near[m, 0], near[m, 1]
            q = 1.0 - distance2(X, i, j) * over_d2
            push = stiffness * ds[i] * ds[j] * q * q
            for c in range(3):
                force = push * (X[c, i] - X[c, j])
                loads[c, i] += force
                loads[c, j] -= force


@part
def push_off_wall(row, fixed, rods, state, loads, velocities):
    """Add the force of the wall on all points that are nearer to it than d/2."""
    z, height, d = state[0][2], fixed[0], fixed[1]
    for k in range(fixed.size - 2):
        share = (z[k] - height) / d
        q = 1.0 - 4.0 * share * share
        if q > 0.0:
            loads[2, k] += 12.8 * fixed[2 + k] * share * q * q * math.sqrt(q)


@kernel(f"void({VEC}, {RODS}, {MAT}, {VEC})")
def pair_energies(fixed, rods, X, out):
    """Add to ``out`` (R,) the energy of all pairs, half of it to each of the two rods."""
    d, strength, counting, ds = _numbers(fixed, rods)
    table, radius, pairs, near = _near(X, rods, d)
    for p in range(pairs.shape[0]):
        a, b, energy = pairs[p, 0], pairs[p, 1], 0.0
        r, s = table[a, ROD], table[b, ROD]
        for m in range(points_within(X, table, radius, a, b, counting, d, near)):
            i, j = near[m, 0], near[m, 1]
            q = 1.0 - distance2(X, i, j) / (d * d)
            energy += min(strength[r], strength[s]) * ds[i] * ds[j] * q * q * q
        out[r] += 0.5 * energy
        out[s] += 0.5 * energy


def wall_energies(fixed, rods, X) -> np.ndarray:
    """Return the energy (R,) of each rod at the wall."""
    z = X[2, : fixed.size - 2] - fixed[0]
    q = np.maximum(1.0 - (2.0 * z / fixed[1]) ** 2, 0.0)
    return np.add.reduceat(16.0 / 35.0 * fixed[1] * fixed[2:] * q**3.5, rods[0])


@kernel(f"Tuple((float64, int64, int64))({VEC}, {RODS}, {MAT}, float64)")
def closest_within(fixed, rods, X, reach):
    """Return (distance, i, j) of the two points nearest to each other, if they push each other.

    (reach, -1, -1) where none are nearer than that.
    """
    counting, least, first, second = _numbers(fixed, rods)[2], reach * reach, -1, -1
    table, radius, pairs, near = _near(X, rods, reach)
    for p in range(pairs.shape[0]):
        a, b = pairs[p, 0], pairs[p, 1]
        for m in range(points_within(X, table, radius, a, b, counting, reach, near)):
            d2 = distance2(X, near[m, 0], near[m, 1])
            if d2 < least:
                least, first, second = d2, int(near[m, 0]), int(near[m, 1])
    return math.sqrt(least), first, second
