"""The gap: smallest distance of two points that are no neighbours, found by blocks. Exact."""

import math

from rodsim.compiled.flags import BOOLS, INTS, MAT, kernel
from rodsim.forces.spheres import BEGIN, END, MIDDLE, ROD, ROUNDING, blocks_of, distance2, span


@kernel(f"Tuple((float64, int64, int64))({MAT}, {INTS}, {INTS}, {BOOLS}, {INTS})")
def closest_pair(X, first, count, closed, excluded):
    """Return (distance, i, j), i < j, of the two points nearest to each other that count.

    Points count if they are of different rods, or more than ``excluded[r]`` segments apart along
    rod r (the shorter way round a closed one): see :mod:`rodsim.scene.neighbours`. first, count,
    closed (R,): as in ``Rods.tables``. (inf, -1, -1) where none counts.

    Blocks further apart than the best pair so far are left out. Blocks next to each other along the
    rods come first: they soon give a small distance. No state, no threads: the same bits at every
    call.
    """
    table, radius = blocks_of(X, first, count)
    best2, best, best_i, best_j = math.inf, math.inf, -1, -1
    for offset in range(table.shape[0]):
        for a in range(table.shape[0] - offset):
            b = a + offset
            between = math.sqrt(distance2(X, table[a, MIDDLE], table[b, MIDDLE]))
            reach = radius[a] + radius[b]
            if between - reach > best + ROUNDING * (between + reach):
                continue
            r, same = table[a, ROD], table[a, ROD] == table[b, ROD]
            rod = same, count[r], closed[r], excluded[r]
            for i in range(table[a, BEGIN], table[a, END]):
                begin, end = span(i, table[b, BEGIN], table[b, END], *rod)
                for j in range(max(i + 1, begin), end):
                    d2 = distance2(X, i, j)
                    if d2 < best2:
                        best2, best_i, best_j = d2, i, j
            best = math.sqrt(best2)
    return math.sqrt(best2), best_i, best_j
