"""Bounds of arcs where they are now: a capsule around each, and how far it is from smooth.

A capsule is the chord of an arc, from its first point to its last, with a radius. ``half`` is half
of the arc's length, ``rough`` how far its points lie off their own interpolant. Those of halved
arcs come from the proxies of their halves: 2 n points stand for all, which is a matter of speed and
not of truth, for the error of the sums is measured.
"""

import math

from numba import prange

from rodsim.compiled.flags import INT_MAT32, INTS32, MAT, VEC, inline, kernel, threaded_kernel
from rodsim.flows.fast.arcs import COUNT, LO, PROXIES, RIGHT, START, WEIGHT

ARCS = f"{INT_MAT32}, {INTS32}, {VEC}, {INT_MAT32}, {INTS32}"  # nodes ... tops, see Arcs
RADIUS, HALF, ROUGH = range(3)  # rows of bounds


@inline
def _distance(X, i, j):
    dx, dy, dz = X[0, i] - X[0, j], X[1, i] - X[1, j], X[2, i] - X[2, j]
    return math.sqrt(dx * dx + dy * dy + dz * dz)


@inline
def off_chord(x, y, z, X, first, last):
    """Return the distance of (x, y, z) from the segment between two points."""
    ax, ay, az = X[0, first], X[1, first], X[2, first]
    dx, dy, dz = X[0, last] - ax, X[1, last] - ay, X[2, last] - az
    px, py, pz = x - ax, y - ay, z - az
    length2 = dx * dx + dy * dy + dz * dz
    share = 0.0
    if length2 > 0.0:
        share = min(1.0, max(0.0, (px * dx + py * dy + pz * dz) / length2))
    px, py, pz = px - share * dx, py - share * dy, pz - share * dz
    return math.sqrt(px * px + py * py + pz * pz)


@inline
def _off_interpolant(X, point, own, weights, begin, stride):
    """Return how far a point lies off the interpolant through an arc's proxies."""
    x, y, z = X[0, point], X[1, point], X[2, point]
    for j in range(own.size):
        w, i = weights[begin + j * stride], own[j]
        x, y, z = x - w * X[0, i], y - w * X[1, i], z - w * X[2, i]
    return math.sqrt(x * x + y * y + z * z)


@inline
def _of_leaf(X, node, proxies, weights, bounds, a):
    lo, m = node[LO], node[COUNT]
    own = proxies[node[START] : node[START] + node[PROXIES]]
    radius = rough = length = 0.0
    for k in range(m):
        point = lo + k
        radius = max(radius, off_chord(X[0, point], X[1, point], X[2, point], X, lo, lo + m - 1))
        if m > own.size:
            rough = max(rough, _off_interpolant(X, point, own, weights, node[WEIGHT] + k, m))
        if k > 0:
            length += _distance(X, point - 1, point)
    bounds[RADIUS, a], bounds[HALF, a], bounds[ROUGH, a] = radius, 0.5 * length, rough


@inline
def _of_halved(X, nodes, proxies, weights, bounds, a):
    node, right = nodes[a], nodes[nodes[a, RIGHT]]
    left = nodes[a + 1]
    lo, m = node[LO], node[COUNT]
    own = proxies[node[START] : node[START] + node[PROXIES]]
    stride, at = left[PROXIES] + right[PROXIES], node[WEIGHT]
    radius = rough = 0.0
    for half in (left, right):
        for slot in range(half[START], half[START] + half[PROXIES]):
            point = proxies[slot]
            off = off_chord(X[0, point], X[1, point], X[2, point], X, lo, lo + m - 1)
            radius = max(radius, off)
            rough = max(rough, _off_interpolant(X, point, own, weights, at, stride))
            at += 1
    r = node[RIGHT]
    between = _distance(X, right[LO] - 1, right[LO])
    bounds[RADIUS, a] = radius
    bounds[HALF, a] = bounds[HALF, a + 1] + bounds[HALF, r] + 0.5 * between
    bounds[ROUGH, a] = rough + max(bounds[ROUGH, a + 1], bounds[ROUGH, r])


@kernel(f"void({MAT}, int64, int64, {ARCS}, {MAT})")
def _bound(X, begin, end, nodes, proxies, weights, chunks, tops, bounds):
    """Bound the arcs begin <= a < end, halves before what they make."""
    for a in range(end - 1, begin - 1, -1):
        if nodes[a, RIGHT] == 0:
            _of_leaf(X, nodes[a], proxies, weights, bounds, a)
        else:
            _of_halved(X, nodes, proxies, weights, bounds, a)


@threaded_kernel(f"void({MAT}, {ARCS}, {MAT})")
def bound(X, nodes, proxies, weights, chunks, tops, bounds):
    """Write radius, half length and roughness of all arcs into ``bounds`` (3, K)."""
    for c in prange(chunks.shape[0]):
        _bound(X, chunks[c, 0], chunks[c, 1], nodes, proxies, weights, chunks, tops, bounds)
    for t in range(tops.size - 1, -1, -1):
        _bound(X, tops[t], tops[t] + 1, nodes, proxies, weights, chunks, tops, bounds)
