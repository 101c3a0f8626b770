"""Derivatives of the loads by differences, compiled: a few groups of nodes displaced together."""

import numpy as np

from rodsim.compiled.flags import INT_MAT, INTS, MAT, RODS, STATE, VEC, inline, kernel
from rodsim.compiled.rotations import displace
from rodsim.scene.loop import CALLS, evaluate

BLOCKS = "float64[:, :, :, ::1]"


@inline
def _put(state, k, out):
    """Write node k of a state into another one."""
    for c in range(3):
        out[0][c, k] = state[0][c, k]
        for i in range(3):
            out[1][i, c, k] = state[1][i, c, k]


@kernel(
    f"void({CALLS}, {VEC}, {RODS}, {STATE}, {MAT}, {INT_MAT}, {INTS}, int64, "
    f"UniTuple({MAT}, 2), {STATE}, {STATE}, {BLOCKS})"
)
def differences(
    table, numbers, driven, rods, state, steps, nearby, groups, count, stencils, mixed, end, blocks
):
    """Add -d(load c of node nearby[o, k])/d(z_axis of node k) to ``blocks`` [o, k, c, axis].

    A list of forces as in :func:`rodsim.scene.loop.evaluate`; steps (6, N) of z; nearby (3, N) the
    node before, itself, and after, -1 where there is none; groups (N,) the number, below ``count``,
    of each node's group; stencils (S, 2), for positions and for rotations: multiples of a step and
    their weights. mixed, end: room for two states.
    """
    n = groups.size
    y = np.empty(6 * n + state[2].size)
    loads, still, none = np.empty((6, n)), np.empty((6, n)), np.empty((3, state[2].shape[1]))
    own = np.empty((0, 6, n))
    for k in range(n):
        _put(state, k, mixed)
    for axis in range(6):
        stencil = stencils[axis // 3]
        for s in range(stencil.shape[0]):
            y[:] = 0.0
            for k in range(n):
                y[axis * n + k] = stencil[s, 0] * steps[axis, k]
            displace(state, y, end)
            for group in range(count):
                for k in range(n):
                    if groups[k] == group:
                        _put(end, k, mixed)
                loads[:] = 0.0
                evaluate(table, numbers, driven, rods, mixed, loads, (still, none), own)
                for k in range(n):
                    if groups[k] != group:
                        continue
                    _put(state, k, mixed)
                    weight = -stencil[s, 1] / steps[axis, k]
                    for o in range(3):
                        if nearby[o, k] >= 0:
                            for c in range(6):
                                blocks[o, k, c, axis] += weight * loads[c, nearby[o, k]]
