"""Which points of rods can be near to each other: runs of consecutive points, each in a sphere.

Two blocks further apart than their spheres and a reach have no two points within that reach. Up to
``FEW`` blocks all pairs of them are looked at; beyond, only those in neighbouring cells of a grid,
which is O(N). No state, no threads: the same bits at every call.
"""

import math

import numpy as np

from rodsim.compiled.flags import inline, unsigned

BLOCK = 16  # consecutive points of a rod
FEW = 250  # blocks; measured: benchmarks/README.md
ROUNDING = 1e-12  # relative, of a bound: more than distances and radii can err
ROD, BEGIN, END, MIDDLE = range(4)  # columns of a table of blocks


@inline
def distance2(X, i, j):
    """Return the squared distance of two points of X (3, N)."""
    return (X[0, i] - X[0, j]) ** 2 + (X[1, i] - X[1, j]) ** 2 + (X[2, i] - X[2, j]) ** 2


@unsigned
def blocks_of(X, first, count):
    """Return the blocks of all rods and the radii of spheres around their middle points.

    table (B, 4): rod, first point, end, middle point of each. A block is of one rod.
    """
    blocks = 0
    for r in range(first.size):
        blocks += (count[r] + BLOCK - 1) // BLOCK
    table, radius, n = np.empty((blocks, 4), dtype=np.int64), np.empty(blocks), 0
    for r in range(first.size):
        end = first[r] + count[r]
        for begin in range(first[r], end, BLOCK):
            stop = min(begin + BLOCK, end)
            middle, radius2 = (begin + stop - 1) // 2, 0.0
            for k in range(begin, stop):
                radius2 = max(radius2, distance2(X, middle, k))
            table[n, ROD], table[n, BEGIN], table[n, END], table[n, MIDDLE] = r, begin, stop, middle
            radius[n] = math.sqrt(radius2)
            n += 1
    return table, radius


@unsigned
def span(i, begin, end, same, count, closed, excluded):
    """Return from where to where the points of a block count for point i of a block before it.

    Of the same rod they do if more than ``excluded`` segments apart, either way round a closed one.
    """
    if not same:
        return begin, end
    if closed:
        end = min(end, i + count - excluded)
    return max(begin, i + excluded + 1), end


@unsigned
def _too_near_along(begin, end, other, last, count, closed, excluded):
    """Tell whether no point of a block counts for any of another one, further on along its rod."""
    return last - 1 - begin <= excluded or (closed and other + 1 - end >= count - excluded)


@inline
def points_within(X, table, radius, a, b, counting, reach, found):
    """Write the pairs of points i < j of two blocks a <= b that are within ``reach`` and count.

    Into the first rows of ``found`` (BLOCK^2, 2); returns how many. Points count if they are of
    different rods, or more than ``excluded[r]`` segments apart along rod r, the shorter way round a
    closed one. counting: ``count`` and ``closed`` of the rods as in ``nodes.Rods.tables``, and
    ``excluded``. Inline: a call with so many arrays costs more than most pairs of blocks.
    """
    r, same, n = table[a, ROD], table[a, ROD] == table[b, ROD], 0
    rod = counting[0][r], counting[1][r], counting[2][r]
    one, two, last = table[a, END], table[b, BEGIN], table[b, END]
    if same and _too_near_along(table[a, BEGIN], one, two, last, *rod):
        return 0
    far = (radius[b] + reach) * (1.0 + ROUNDING)
    for i in range(table[a, BEGIN], one):
        k = np.uint64(i)
        if distance2(X, k, np.uint64(table[b, MIDDLE])) > far * far:
            continue
        begin, end = span(i, two, last, same, *rod)
        x, y, z = X[0, k], X[1, k], X[2, k]
        for j in range(np.uint64(begin), np.uint64(max(begin, end))):
            dx, dy, dz = x - X[0, j], y - X[1, j], z - X[2, j]
            if dx * dx + dy * dy + dz * dz < reach * reach:
                found[n, 0], found[n, 1] = i, j
                n += 1
    return n


@unsigned
def near_blocks(X, table, radius, reach):
    """Return all pairs (n, 2) of blocks a <= b that may hold points within ``reach``."""
    if table.shape[0] <= FEW:
        return _all_pairs(X, table, radius, reach)
    return _pairs_in_cells(X, table, radius, reach)


@inline
def _are_near(X, table, radius, reach, a, b):
    far = (radius[a] + radius[b] + reach) * (1.0 + ROUNDING)
    return distance2(X, np.uint64(table[a, MIDDLE]), np.uint64(table[b, MIDDLE])) <= far * far


@unsigned
def _with_room(pairs, n):
    """Return pairs in an array with room for n, twice as large where it had not.

    Asked for outside of the inner loops: there it costs more than all else.
    """
    if n <= pairs.shape[0]:
        return pairs
    larger = np.empty((2 * n, pairs.shape[1]), dtype=np.int64)
    larger[: pairs.shape[0]] = pairs
    return larger


@unsigned
def _all_pairs(X, table, radius, reach):
    blocks, n = table.shape[0], 0
    pairs = np.empty((4 * blocks, 2), dtype=np.int64)
    for a in range(blocks):
        pairs = _with_room(pairs, n + blocks - a)
        for b in range(a, blocks):
            if _are_near(X, table, radius, reach, a, b):
                pairs[n, 0], pairs[n, 1] = a, b
                n += 1
    return pairs[:n]


@inline
def _bucket(x, y, z, mask):
    return (x * 73856093 ^ y * 19349663 ^ z * 83492791) & mask


@unsigned
def _sorted_into_cells(X, table, size):
    """Return cell (B, 3) of each block, and the blocks sorted by the bucket of their cell.

    start (buckets + 1,), items (B,): blocks items[start[h]:start[h + 1]] are in bucket h. Cells
    that share a bucket are told apart by their numbers.
    """
    blocks, buckets = table.shape[0], 1
    while buckets < blocks:
        buckets *= 2
    cell, start = np.empty((blocks, 3), dtype=np.int64), np.zeros(buckets + 1, dtype=np.int64)
    for a in range(blocks):
        for c in range(3):
            cell[a, c] = math.floor(X[c, table[a, MIDDLE]] / size)
        start[_bucket(cell[a, 0], cell[a, 1], cell[a, 2], buckets - 1) + 1] += 1
    for h in range(buckets):
        start[h + 1] += start[h]
    items, place = np.empty(blocks, dtype=np.int64), start.copy()
    for a in range(blocks):
        h = _bucket(cell[a, 0], cell[a, 1], cell[a, 2], buckets - 1)
        items[place[h]] = a
        place[h] += 1
    return cell, start, items


@unsigned
def _pairs_in_cells(X, table, radius, reach):
    """Look at the cell of each block and at half of the 26 around it: no pair comes twice."""
    size = (2.0 * radius.max() + reach) * (1.0 + ROUNDING)
    cell, start, items = _sorted_into_cells(X, table, size)
    mask = start.size - 2
    pairs, n = np.empty((4 * table.shape[0], 2), dtype=np.int64), 0
    for a in range(table.shape[0]):
        for way in range(13, 27):  # 13 is the cell itself
            x = cell[a, 0] + way // 9 - 1
            y = cell[a, 1] + way // 3 % 3 - 1
            z = cell[a, 2] + way % 3 - 1
            h = _bucket(x, y, z, mask)
            pairs = _with_room(pairs, n + start[h + 1] - start[h])
            for m in range(start[h], start[h + 1]):
                b = items[m]
                here = cell[b, 0] == x and cell[b, 1] == y and cell[b, 2] == z
                if not here or (way == 13 and b < a):
                    continue
                if _are_near(X, table, radius, reach, a, b):
                    pairs[n, 0], pairs[n, 1] = min(a, b), max(a, b)
                    n += 1
    return pairs[:n]
