"""The gap: smallest distance of two points that are no neighbours, found by blocks. Exact."""

import math

import numpy as np

from rodsim.compiled.flags import BOOLS, INTS, MAT, inline, kernel

BLOCK = 16  # consecutive points of a rod
ROUNDING = 1e-12  # relative, of a bound: more than distances and radii can err


@inline
def _distance2(X, i, j):
    return (X[0, i] - X[0, j]) ** 2 + (X[1, i] - X[1, j]) ** 2 + (X[2, i] - X[2, j]) ** 2


@inline
def _bound(X, begin, end):
    """Return centre and radius of a sphere around the points begin <= k < end."""
    half = (begin + end - 1) // 2
    radius2 = 0.0
    for k in range(begin, end):
        radius2 = max(radius2, _distance2(X, half, k))
    return half, math.sqrt(radius2)


@kernel(f"Tuple((float64, int64, int64))({MAT}, {INTS}, {INTS}, {BOOLS}, {INTS})")
def closest_pair(X, first, count, closed, excluded):
    """Return (distance, i, j), i < j, of the two points nearest to each other that count.

    Points count if they are of different rods, or more than ``excluded[r]`` segments apart along
    rod r (the shorter way round a closed one): see :mod:`rodsim.scene.neighbours`. first, count,
    closed (R,): as in ``Rods.tables``. (inf, -1, -1) where none counts.

    Runs of 16 consecutive points lie in spheres around one of them; two spheres further apart than
    the best pair so far are left out. Blocks next to each other along the rods come first: they
    soon give a small distance. No state, no threads: the same bits at every call.
    """
    blocks = 0
    for r in range(first.size):
        blocks += (count[r] + BLOCK - 1) // BLOCK
    table = np.empty((blocks, 4), dtype=np.int64)  # rod, first point, end, point in the middle
    radius = np.empty(blocks)
    n = 0
    for r in range(first.size):
        end = first[r] + count[r]
        for begin in range(first[r], end, BLOCK):
            stop = min(begin + BLOCK, end)
            middle, radius[n] = _bound(X, begin, stop)
            table[n, 0], table[n, 1], table[n, 2], table[n, 3] = r, begin, stop, middle
            n += 1

    best2, best, best_i, best_j = math.inf, math.inf, -1, -1
    for offset in range(blocks):
        for a in range(blocks - offset):
            b = a + offset
            between = math.sqrt(_distance2(X, table[a, 3], table[b, 3]))
            reach = radius[a] + radius[b]
            if between - reach > best + ROUNDING * (between + reach):
                continue
            r, same = table[a, 0], table[a, 0] == table[b, 0]
            for i in range(table[a, 1], table[a, 2]):
                for j in range(max(i + 1, table[b, 1]), table[b, 2]):
                    d2 = _distance2(X, i, j)
                    if d2 < best2:
                        apart = min(j - i, count[r] - (j - i)) if closed[r] else j - i
                        if not same or apart > excluded[r]:
                            best2, best_i, best_j = d2, i, j
            best = math.sqrt(best2)
    return math.sqrt(best2), best_i, best_j
