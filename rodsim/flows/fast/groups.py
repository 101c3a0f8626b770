"""Targets that are no sources, such as tracers: in groups, each with its far and near arcs.

A group is what repeated halving along the longest side of the box around the targets leaves, in a
ball around the middle of its box. Far arcs act by their proxies on each target itself: nothing is
interpolated there, so targets may lie anywhere, also on a rod. The rule of what is far is that of
:mod:`rodsim.flows.fast.lists`, for the arc alone.
"""

import math

import numpy as np

from rodsim.compiled.flags import INT_MAT32, INTS32, MAT, inline, kernel
from rodsim.flows.fast.arcs import COUNT, LO, RIGHT
from rodsim.flows.fast.bounds import HALF, RADIUS, ROUGH, off_chord
from rodsim.flows.fast.lists import DEPTH

MOST = 64  # targets in a group


@inline
def _box(targets, order, begin, end, low, high):
    low[:], high[:] = math.inf, -math.inf
    for k in range(begin, end):
        for c in range(3):
            low[c] = min(low[c], targets[c, order[k]])
            high[c] = max(high[c], targets[c, order[k]])


@kernel(f"Tuple(({INTS32}, {INTS32}))({MAT})")
def grouped(targets):
    """Return targets (3, T) in an order, and where each group begins: (T,), (G + 1,)."""
    count = targets.shape[1]
    order = np.arange(count).astype(np.int32)
    begins = np.empty(count + 1, dtype=np.int32)
    stack, top, groups = np.empty((DEPTH, 2), dtype=np.int64), 0, 0
    low, high = np.empty(3), np.empty(3)
    if count > 0:
        stack[0, 0], stack[0, 1], top = 0, count, 1
    while top > 0:
        top -= 1
        begin, end = stack[top, 0], stack[top, 1]
        if end - begin <= MOST:
            begins[groups] = begin
            groups += 1
            continue
        _box(targets, order, begin, end, low, high)
        axis = np.argmax(high - low)
        along = np.empty(end - begin)
        for k in range(begin, end):
            along[k - begin] = targets[axis, order[k]]
        order[begin:end] = order[begin:end][np.argsort(along, kind="mergesort")]
        middle = (begin + end) // 2
        stack[top, 0], stack[top, 1] = middle, end
        stack[top + 1, 0], stack[top + 1, 1] = begin, middle
        top += 2
    begins[groups] = count
    return order, begins[: groups + 1].copy()


@inline
def _look(points, nodes, bounds, roots, middle, radius, theta, smooth, stack, far, near):
    """Write the far and near arcs of a ball, as far as there is room; return how many there are."""
    top = nfar = nnear = 0
    for root in roots:
        stack[0], top = root, 1
        while top > 0:
            top -= 1
            a = stack[top]
            first, last = nodes[a, LO], nodes[a, LO] + nodes[a, COUNT] - 1
            apart = off_chord(middle[0], middle[1], middle[2], points, first, last)
            gap = apart - bounds[RADIUS, a] - radius
            distant = gap > 0.0 and theta * gap >= bounds[HALF, a]
            if distant and bounds[ROUGH, a] <= smooth * gap:
                if nfar < far.size:
                    far[nfar] = a
                nfar += 1
            elif nodes[a, RIGHT] == 0:
                if nnear < near.size:
                    near[nnear] = a
                nnear += 1
            else:
                stack[top], stack[top + 1] = nodes[a, RIGHT], a + 1
                top += 2
    return nfar, nnear


@inline
def _wider(array, used, size):
    if size <= array.size:
        return array
    wider = np.empty(size, dtype=np.int32)
    wider[:used] = array[:used]
    return wider


@kernel(
    f"UniTuple({INTS32}, 4)({MAT}, {MAT}, {INTS32}, {INTS32}, {INT_MAT32}, {MAT}, {INTS32}, "
    "float64, float64)"
)
def lists_of_groups(points, targets, order, begins, nodes, bounds, roots, theta, smooth):
    """Return (begins, arcs) of all groups' far arcs, and of their near ones."""
    groups = begins.size - 1
    low, high = np.empty(3), np.empty(3)
    stack = np.empty(DEPTH, dtype=np.int64)
    far, near = np.empty(1024, dtype=np.int32), np.empty(1024, dtype=np.int32)
    ends = np.zeros((2, groups + 1), dtype=np.int32)
    for g in range(groups):
        _box(targets, order, begins[g], begins[g + 1], low, high)
        middle, radius = 0.5 * (low + high), 0.0
        for k in range(begins[g], begins[g + 1]):
            away = 0.0
            for c in range(3):
                away += (targets[c, order[k]] - middle[c]) ** 2
            radius = max(radius, math.sqrt(away))
        for _ in range(2):  # once more where there was not enough room
            f, n = _look(
                points, nodes, bounds, roots, middle, radius, theta, smooth, stack,
                far[ends[0, g] :], near[ends[1, g] :],
            )  # fmt: skip
            ends[0, g + 1], ends[1, g + 1] = ends[0, g] + f, ends[1, g] + n
            if ends[0, g + 1] <= far.size and ends[1, g + 1] <= near.size:
                break
            far = _wider(far, ends[0, g], 2 * ends[0, g + 1])
            near = _wider(near, ends[1, g], 2 * ends[1, g + 1])
    return ends[0].copy(), far[: ends[0, groups]].copy(), ends[1].copy(), near[: ends[1, groups]].copy()
