"""Targets that are no sources, such as tracers: in groups, each with its far and near arcs.

A group is what repeated halving along the longest side of the box around the targets leaves, in a
ball around the middle of its box. Far arcs act by their proxies on each target itself: nothing is
interpolated there, so targets may lie anywhere, also on a rod. The rule of what is far is that of
:mod:`rodsim.flows.fast.lists`, for the arc alone.
"""

import math

import numpy as np

from rodsim.compiled.flags import INT_MAT32, INTS32, MAT, VEC, inline, kernel
from rodsim.flows.fast.arcs import COUNT, LO, RIGHT
from rodsim.flows.fast.bounds import HALF, RADIUS, ROUGH, off_chord
from rodsim.flows.fast.lists import DEPTH, TIE

MOST = 64  # targets in a group


def grouped(targets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return targets (3, T) in an order, and where each group begins: (T,), (G + 1,)."""
    order, begins = np.arange(targets.shape[1]), []
    waiting = [(0, targets.shape[1])]
    while waiting:
        begin, end = waiting.pop()
        if end - begin <= MOST:
            begins.append(begin)
            continue
        some = targets[:, order[begin:end]]
        axis = np.argmax(np.ptp(some, axis=1))
        order[begin:end] = order[begin:end][np.argsort(some[axis], kind="stable")]
        middle = (begin + end) // 2
        waiting += [(middle, end), (begin, middle)]
    return order.astype(np.int32), np.array([*begins, targets.shape[1]], dtype=np.int32)


@kernel(f"Tuple(({VEC}, float64))({MAT}, {INTS32})")
def _ball(targets, members):
    """Return the middle of the box around some targets, and how far they are from it."""
    low, high, radius2 = np.full(3, math.inf), np.full(3, -math.inf), 0.0
    for k in members:
        for c in range(3):
            low[c], high[c] = min(low[c], targets[c, k]), max(high[c], targets[c, k])
    for c in range(3):
        low[c] = 0.5 * (low[c] + high[c])
    for k in members:
        dx, dy, dz = targets[0, k] - low[0], targets[1, k] - low[1], targets[2, k] - low[2]
        radius2 = max(radius2, dx * dx + dy * dy + dz * dz)
    return low, math.sqrt(radius2)


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
            distant = gap > 0.0 and theta * gap >= TIE * bounds[HALF, a]
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
    for k in range(used):
        wider[k] = array[k]
    return wider


@kernel(
    f"UniTuple({INTS32}, 4)({MAT}, {MAT}, {INTS32}, {INTS32}, {INT_MAT32}, {MAT}, {INTS32}, "
    "float64, float64)"
)
def lists_of_groups(points, targets, order, begins, nodes, bounds, roots, theta, smooth):
    """Return (begins, arcs) of all groups' far arcs, and of their near ones."""
    groups = begins.size - 1
    stack = np.empty(DEPTH, dtype=np.int64)
    far, near = np.empty(1024, dtype=np.int32), np.empty(1024, dtype=np.int32)
    ends = np.zeros((2, groups + 1), dtype=np.int32)
    for g in range(groups):
        middle, radius = _ball(targets, order[begins[g] : begins[g + 1]])
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
    far, near = far[: ends[0, groups]].copy(), near[: ends[1, groups]].copy()
    return ends[0].copy(), far, ends[1].copy(), near
