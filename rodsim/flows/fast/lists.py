"""Which pairs of arcs are far, and act by their proxies, and which are near, and act as they are.

Two arcs are far where their capsules are apart by a gap with

    theta gap >= half the length of the longer    and    roughness of either <= smooth gap;

a pair that is neither far nor of two arcs that are not halved is split. The gap is the real one:
taking the blob's width into account as well, because the kernel is smooth there, would let arcs
touch, and make some of the stiffest modes grow, however small the error is on average. The lists
are symmetric, and depend on nothing but the points.
"""

import math

import numpy as np
from numba import prange

from rodsim.compiled.flags import (
    INT_MAT32,
    INTS,
    INTS32,
    MAT,
    inline,
    kernel,
    threaded_kernel,
    unsigned,
)
from rodsim.flows.fast.arcs import COUNT, LO, RIGHT
from rodsim.flows.fast.bounds import HALF, RADIUS, ROUGH

TASKS = 2048  # pairs that are looked into at the same time, or more
DEPTH = 256  # of a stack: a pair leaves fewer than 3 behind at each halving
TIE = 1.0 - 1e-9  # arcs of one length, gaps of whole spacings: rounding must not decide
SPLIT_FIRST, SPLIT_SECOND, SPLIT_BOTH, IS_FAR, IS_NEAR = range(5)


@inline
def _clamp(x):
    return min(1.0, max(0.0, x))


@inline
def _between_chords(X, p, q, r, s):
    """Return the distance of the segment of points p, q from that of r, s.

    Ericson, Real-Time Collision Detection (2005), section 5.1.9.
    """
    ux, uy, uz = X[0, q] - X[0, p], X[1, q] - X[1, p], X[2, q] - X[2, p]
    vx, vy, vz = X[0, s] - X[0, r], X[1, s] - X[1, r], X[2, s] - X[2, r]
    wx, wy, wz = X[0, p] - X[0, r], X[1, p] - X[1, r], X[2, p] - X[2, r]
    a, e = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    b, c = ux * vx + uy * vy + uz * vz, ux * wx + uy * wy + uz * wz
    f = vx * wx + vy * wy + vz * wz
    first = second = 0.0
    cross = a * e - b * b
    if cross > 0.0:
        first = _clamp((b * f - c * e) / cross)
    if e > 0.0:
        second = (b * first + f) / e
    if (not 0.0 <= second <= 1.0) or e == 0.0:
        second = _clamp(second)
        first = _clamp((b * second - c) / a) if a > 0.0 else 0.0
    x, y, z = (
        wx + first * ux - second * vx,
        wy + first * uy - second * vy,
        wz + first * uz - second * vz,
    )
    return math.sqrt(x * x + y * y + z * z)


@unsigned
def _verdict(X, nodes, bounds, a, b, theta, smooth):
    """Return what becomes of a pair of arcs."""
    one, two = nodes[a], nodes[b]
    if a == b:
        return SPLIT_BOTH if one[RIGHT] > 0 else IS_NEAR
    apart = _between_chords(X, one[LO], one[LO] + one[COUNT] - 1, two[LO], two[LO] + two[COUNT] - 1)
    gap = apart - bounds[RADIUS, a] - bounds[RADIUS, b]
    longer = max(bounds[HALF, a], bounds[HALF, b])
    rougher = max(bounds[ROUGH, a], bounds[ROUGH, b])
    distant = gap > 0.0 and theta * gap >= TIE * longer
    if distant and rougher <= smooth * gap:
        return IS_FAR
    if one[RIGHT] == 0 and two[RIGHT] == 0:
        return IS_NEAR
    which = ROUGH if distant else HALF
    first = two[RIGHT] == 0 or (one[RIGHT] > 0 and bounds[which, a] >= TIE * bounds[which, b])
    return SPLIT_FIRST if first else SPLIT_SECOND


@inline
def _push(nodes, a, b, verdict, stack, top):
    """Put what a pair is split into on a stack; return its new top."""
    if verdict == SPLIT_BOTH:
        left, right = a + 1, nodes[a, RIGHT]
        stack[top, 0], stack[top, 1] = right, right
        stack[top + 1, 0], stack[top + 1, 1] = left, right
        stack[top + 2, 0], stack[top + 2, 1] = left, left
        return top + 3
    if verdict == SPLIT_FIRST:
        stack[top, 0], stack[top, 1] = nodes[a, RIGHT], b
        stack[top + 1, 0], stack[top + 1, 1] = a + 1, b
    else:
        stack[top, 0], stack[top, 1] = a, nodes[b, RIGHT]
        stack[top + 1, 0], stack[top + 1, 1] = a, b + 1
    return top + 2


@kernel(f"{INT_MAT32}({MAT}, {INT_MAT32}, {MAT}, {INTS32}, float64, float64)")
def _tasks(X, nodes, bounds, roots, theta, smooth):
    """Return pairs that together hold all: those of whole rods, split while they are few."""
    n = roots.size
    pairs = np.empty((n * (n + 1) // 2, 2), dtype=np.int32)
    k = 0
    for i in range(n):
        for j in range(i, n):
            pairs[k, 0], pairs[k, 1] = roots[i], roots[j]
            k += 1
    while pairs.shape[0] < TASKS:
        wider, k = np.empty((3 * pairs.shape[0], 2), dtype=np.int32), 0
        for i in range(pairs.shape[0]):
            a, b = pairs[i, 0], pairs[i, 1]
            verdict = _verdict(X, nodes, bounds, a, b, theta, smooth)
            if verdict >= IS_FAR:
                wider[k, 0], wider[k, 1] = a, b
                k += 1
            else:
                k = _push(nodes, a, b, verdict, wider, k)
        if k == pairs.shape[0]:
            break
        pairs = wider[:k].copy()
    return pairs


@kernel(
    f"void({MAT}, {INT_MAT32}, {MAT}, float64, float64, int64, int64, {INT_MAT32}, {INTS}, "
    f"{INT_MAT32}, {INT_MAT32})"
)
def _look_into(X, nodes, bounds, theta, smooth, a, b, stack, found, far, near):
    """Find the far and near pairs in a pair; with room for them, write them down.

    found : how many there were before, of each kind, and then are.
    """
    top, writing = 1, far.shape[0] + near.shape[0] > 0
    stack[0, 0], stack[0, 1] = a, b
    while top > 0:
        top -= 1
        i, j = stack[top, 0], stack[top, 1]
        verdict = _verdict(X, nodes, bounds, i, j, theta, smooth)
        if verdict == IS_FAR:
            if writing:
                far[found[0], 0], far[found[0], 1] = i, j
            found[0] += 1
        elif verdict == IS_NEAR:
            if writing:
                near[found[1], 0], near[found[1], 1] = i, j
            found[1] += 1
        else:
            top = _push(nodes, i, j, verdict, stack, top)


@threaded_kernel(
    f"Tuple(({INT_MAT32}, {INT_MAT32}))({MAT}, {INT_MAT32}, {MAT}, {INTS32}, float64, float64)"
)
def pairs_of_arcs(X, nodes, bounds, roots, theta, smooth):
    """Return the far pairs (F, 2) and the near ones (G, 2), each once; an arc is near itself.

    X (3, N) : points. Their order does not depend on the number of threads: they are counted, the
    room is shared out, and found once more.
    """
    tasks = _tasks(X, nodes, bounds, roots, theta, smooth)
    blocks = min(tasks.shape[0], TASKS)
    counts = np.zeros((blocks, 2), dtype=np.int64)
    nothing = np.empty((0, 2), dtype=np.int32)
    for block in prange(blocks):
        stack = np.empty((DEPTH, 2), dtype=np.int32)
        for t in range(block, tasks.shape[0], blocks):
            a, b = tasks[t, 0], tasks[t, 1]
            args = stack, counts[block], nothing, nothing
            _look_into(X, nodes, bounds, theta, smooth, a, b, *args)
    ends = np.zeros((blocks + 1, 2), dtype=np.int64)
    for block in range(blocks):
        for kind in range(2):
            ends[block + 1, kind] = ends[block, kind] + counts[block, kind]
    far = np.empty((ends[blocks, 0], 2), dtype=np.int32)
    near = np.empty((ends[blocks, 1], 2), dtype=np.int32)
    for block in prange(blocks):
        stack, found = np.empty((DEPTH, 2), dtype=np.int32), ends[block].copy()
        for t in range(block, tasks.shape[0], blocks):
            a, b = tasks[t, 0], tasks[t, 1]
            _look_into(X, nodes, bounds, theta, smooth, a, b, stack, found, far, near)
    return far, near


@kernel(f"Tuple(({INTS32}, {INTS32}))({INT_MAT32}, int64)")
def both_ways(pairs, n):
    """Return (begins (n + 1,), partners): of arc a, those from begins[a] on. A counting sort."""
    begins = np.zeros(n + 1, dtype=np.int32)
    for k in range(pairs.shape[0]):
        a, b = pairs[k, 0], pairs[k, 1]
        begins[a + 1] += 1
        if a != b:
            begins[b + 1] += 1
    for a in range(n):
        begins[a + 1] += begins[a]
    partners, filled = np.empty(begins[n], dtype=np.int32), begins.copy()
    for k in range(pairs.shape[0]):
        a, b = pairs[k, 0], pairs[k, 1]
        partners[filled[a]] = b
        filled[a] += 1
        if a != b:
            partners[filled[b]] = a
            filled[b] += 1
    return begins, partners
