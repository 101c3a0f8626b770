"""Up and down the arcs: loads go from points to proxies, velocities from proxies to points.

Both are the same matrix P and its transpose, so that the mobility P^T K P is symmetric if K is.
"""

from functools import partial

import numpy as np
from numba import prange

from rodsim.compiled.flags import MAT, SUM_FLAGS, kernel, threaded_kernel
from rodsim.flows.fast.arcs import COUNT, LO, PROXIES, RIGHT, START, WEIGHT
from rodsim.flows.fast.bounds import ARCS

summing = partial(kernel, fastmath=SUM_FLAGS)


@summing
def _spread(w, stride, values, begin, count, out, start, p):
    """Add ``count`` loads to those of p proxies: out_j += sum_k W_jk values_k."""
    begin, stride, row = np.uint64(begin), np.uint64(stride), np.uint64(0)
    for j in range(p):
        for c in range(6):
            total = 0.0
            for k in range(np.uint64(count)):
                total += w[row + k] * values[c, begin + k]
            out[c, start + j] += total
        row += stride


@kernel(f"void({MAT}, {MAT}, int64, int64, {ARCS}, {MAT}, {MAT})")
def _up(points, loads, begin, end, nodes, slots, weights, chunks, tops, places, shares):
    """Gather at the proxies of the arcs begin <= a < end, halves before what they make."""
    for a in range(end - 1, begin - 1, -1):
        node = nodes[a]
        start, p, w = node[START], node[PROXIES], weights[node[WEIGHT] :]
        for slot in range(start, start + p):
            for c in range(3):
                places[c, slot] = points[c, slots[slot]]
            for c in range(6):
                shares[c, slot] = 0.0
        if node[RIGHT] == 0:
            _spread(w, node[COUNT], loads, node[LO], node[COUNT], shares, start, p)
            continue
        left, right = nodes[a + 1], nodes[node[RIGHT]]
        before, after = left[PROXIES], right[PROXIES]
        _spread(w, before + after, shares, left[START], before, shares, start, p)
        _spread(w[before:], before + after, shares, right[START], after, shares, start, p)


@threaded_kernel(f"UniTuple({MAT}, 3)({ARCS}, {MAT}, {MAT})")
def up(nodes, slots, weights, chunks, tops, points, loads):
    """Return places (3, Q) and loads (6, Q) of all proxies, and velocities (6, Q) at zero."""
    arcs = nodes, slots, weights, chunks, tops
    places, shares = np.empty((3, slots.size)), np.empty((6, slots.size))
    for c in prange(chunks.shape[0]):
        _up(points, loads, chunks[c, 0], chunks[c, 1], *arcs, places, shares)
    for t in range(tops.size - 1, -1, -1):
        _up(points, loads, tops[t], tops[t] + 1, *arcs, places, shares)
    return places, shares, np.zeros((6, slots.size))


@summing
def collect(w, stride, values, start, p, scale, out, begin, count):
    """Add velocities of p proxies to points: out_k += scale sum_j W_jk values_j."""
    begin, stride, row = np.uint64(begin), np.uint64(stride), np.uint64(0)
    for j in range(p):
        for c in range(6):
            value = scale * values[c, start + j]
            for k in range(np.uint64(count)):
                out[c, begin + k] += w[row + k] * value
        row += stride


@kernel(f"void(int64, int64, {ARCS}, float64, {MAT}, {MAT})")
def _down(begin, end, nodes, slots, weights, chunks, tops, scale, velocities, out):
    """Hand the velocities at the proxies of begin <= a < end on to those of their halves."""
    for a in range(begin, end):
        node = nodes[a]
        start, p, w = node[START], node[PROXIES], weights[node[WEIGHT] :]
        if node[RIGHT] == 0:
            collect(w, node[COUNT], velocities, start, p, scale, out, node[LO], node[COUNT])
            continue
        left, right = nodes[a + 1], nodes[node[RIGHT]]
        before, after = left[PROXIES], right[PROXIES]
        stride, v = before + after, velocities
        collect(w, stride, v, start, p, 1.0, v, left[START], before)
        collect(w[before:], stride, v, start, p, 1.0, v, right[START], after)


@threaded_kernel(f"void({ARCS}, float64, {MAT}, {MAT})")
def down(nodes, slots, weights, chunks, tops, scale, velocities, out):
    """Hand velocities (6, Q) on from proxies to those of halves, and add to points: out (6, N)."""
    arcs = nodes, slots, weights, chunks, tops
    for t in range(tops.size):
        _down(tops[t], tops[t] + 1, *arcs, scale, velocities, out)
    for c in prange(chunks.shape[0]):
        _down(chunks[c, 0], chunks[c, 1], *arcs, scale, velocities, out)


@kernel(f"void({MAT}, float64, float64, {MAT})")
def add_own(loads, own_force, own_torque, out):
    """Add to each point so much of its own force, and of its own torque."""
    for c in range(6):
        share = own_force if c < 3 else own_torque
        for k in range(np.uint64(loads.shape[1])):
            out[c, k] += share * loads[c, k]


LANES = 8  # sources come in multiples of it, the rest without loads: what is left over is slow


@summing
def room_for(count):
    """Return places (3, n) and loads (6, n) for so many sources, the last few without loads."""
    n = (count + LANES - 1) // LANES * LANES
    places, loads = np.empty((3, n)), np.empty((6, n))
    for k in range(count, n):
        places[0, k] = places[1, k] = places[2, k] = 0.0
        for c in range(6):
            loads[c, k] = 0.0
    return places, loads


@summing
def copy_sources(places, loads, begin, count, to_places, to_loads, at):
    """Copy ``count`` sources; return where the next ones go."""
    begin, here = np.uint64(begin), np.uint64(at)
    for k in range(np.uint64(count)):
        for c in range(3):
            to_places[c, here + k] = places[c, begin + k]
        for c in range(6):
            to_loads[c, here + k] = loads[c, begin + k]
    return at + count
