"""The sums of ``free.py`` and ``wall.py`` by arcs: far ones by proxies, near ones as they are.

The exact sum is u = K g; here u = P^T K P g over far pairs of arcs and K g over near ones, with the
same kernel K. At a wall it is K with all images at once: no point is closer to an image than to
what it is the image of, so arcs that are far from each other are far from the images too. Threads
share out the arcs; all inside of one is serial, in an order that the lists fix, so the result does
not depend on the number of threads.
"""

import numpy as np
from numba import prange

from rodsim.compiled.flags import threaded_kernel, unsigned
from rodsim.flows.blobs import ALGEBRAIC7, ALGEBRAIC9
from rodsim.flows.fast.arcs import COUNT, LO, PROXIES, START
from rodsim.flows.fast.packed import (
    CHUNKS,
    EPSILON,
    FAR,
    FAR_BEGINS,
    FAR_WORK,
    GROUPS,
    NEAR,
    NEAR_BEGINS,
    NEAR_WORK,
    NODES,
    OWN_FORCE,
    OWN_TORQUE,
    SAMPLE_FAR,
    SAMPLE_NEAR,
    SLOTS,
    TARGETS,
    TOPS,
    VISCOSITY,
    WALL,
    WEIGHTS,
    floats,
    integers,
    rows,
    work,
)
from rodsim.flows.fast.passes import add_own, copy_sources, down, room_for, up
from rodsim.flows.free import EIGHT_PI, add_up
from rodsim.flows.images import add_up as add_up_at_wall


@unsigned
def _total(nodes, partners, count):
    total = 0
    for b in partners:
        total += nodes[b, count]
    return total


@unsigned
def _gather(nodes, partners, first, count, places, loads, to_places, to_loads, at):
    """Copy the sources of some arcs, those that two columns of ``nodes`` name; return the end."""
    for b in partners:
        at = copy_sources(places, loads, nodes[b, first], nodes[b, count], to_places, to_loads, at)
    return at


@unsigned
def _sources(nodes, partners, first, count, places, loads):
    """Return places (3, n) and loads (6, n) of some arcs: of their points, or their proxies."""
    to_places, to_loads = room_for(_total(nodes, partners, count))
    _gather(nodes, partners, first, count, places, loads, to_places, to_loads, 0)
    return to_places, to_loads


@unsigned
def _far_lists(fixed, sampled):
    """Return arcs in the order of work, its shares, and of each arc those that are far from it."""
    todo = work(fixed, SAMPLE_FAR if sampled else FAR_WORK)
    return *todo, integers(fixed, FAR_BEGINS), integers(fixed, FAR)


@unsigned
def _near_lists(fixed, sampled):
    """Return the same for those that are near."""
    todo = work(fixed, SAMPLE_NEAR if sampled else NEAR_WORK)
    return *todo, integers(fixed, NEAR_BEGINS), integers(fixed, NEAR)


def _fast_sum(walled, blob, planar):
    """Make the whole sum of a blob, in free fluid or at a wall, for any scene or a planar one."""

    @threaded_kernel
    def fast_sum(fixed, points, loads, sampled, out):
        e2, wall = fixed[EPSILON] * fixed[EPSILON], fixed[WALL]
        scale = 1.0 / (EIGHT_PI * fixed[VISCOSITY])
        nodes, weights = rows(fixed, NODES, 6), floats(fixed, WEIGHTS)
        arcs = nodes, integers(fixed, SLOTS), weights, rows(fixed, CHUNKS, 2), integers(fixed, TOPS)
        places, shared, far = up(*arcs, points, loads)
        # First all proxies act on proxies; then all points on points, and the far adds to them.
        at, g, to, first, count, factor = places, shared, far, START, PROXIES, 1.0
        order, shares, begins, partners = _far_lists(fixed, sampled)
        for near in range(2):
            if near:
                down(*arcs, scale, far, out)
                add_own(loads, fixed[OWN_FORCE], fixed[OWN_TORQUE], out)
                at, g, to, first, count, factor = points, loads, out, LO, COUNT, scale
                order, shares, begins, partners = _near_lists(fixed, sampled)
            for share in prange(shares.size - 1):
                for k in range(shares[share], shares[share + 1]):
                    a = order[k]
                    others = partners[begins[a] : begins[a + 1]]
                    sources, theirs = _sources(nodes, others, first, count, at, g)
                    room = np.empty((2, sources.shape[1] if walled else 0))
                    for i in range(nodes[a, first], nodes[a, first] + nodes[a, count]):
                        x, y, z = at[0, i], at[1, i], at[2, i]
                        if walled:
                            six = add_up_at_wall(
                                blob, planar, True, False, x, y, z, sources, theirs, room, wall, e2
                            )
                        else:
                            six = add_up(blob, planar, True, False, x, y, z, sources, theirs, e2)
                        for c in range(6):
                            to[c, i] += factor * six[c]

    return fast_sum


def _group_sum(walled, blob, angular):
    """Make the sum of a blob at targets in groups, with or without w."""

    @threaded_kernel
    def group_sum(fixed, targets, points, loads, sampled, out):
        e2, wall = fixed[EPSILON] * fixed[EPSILON], fixed[WALL]
        scale = 1.0 / (EIGHT_PI * fixed[VISCOSITY])
        nodes, weights = rows(fixed, NODES, 6), floats(fixed, WEIGHTS)
        arcs = nodes, integers(fixed, SLOTS), weights, rows(fixed, CHUNKS, 2), integers(fixed, TOPS)
        places, shared, _ = up(*arcs, points, loads)
        order, members = integers(fixed, TARGETS), integers(fixed, GROUPS)
        far_begins, far = integers(fixed, FAR_BEGINS), integers(fixed, FAR)
        near_begins, near = integers(fixed, NEAR_BEGINS), integers(fixed, NEAR)
        groups, shares = work(fixed, SAMPLE_NEAR if sampled else NEAR_WORK)
        for share in prange(shares.size - 1):
            for k in range(shares[share], shares[share + 1]):
                a = groups[k]
                afar = far[far_begins[a] : far_begins[a + 1]]
                close = near[near_begins[a] : near_begins[a + 1]]
                count = _total(nodes, afar, PROXIES) + _total(nodes, close, COUNT)
                sources, g = room_for(count)
                room = np.empty((2, sources.shape[1] if walled else 0))
                end = _gather(nodes, afar, START, PROXIES, places, shared, sources, g, 0)
                _gather(nodes, close, LO, COUNT, points, loads, sources, g, end)
                for t in range(members[a], members[a + 1]):
                    i = order[t]
                    x, y, z = targets[0, i], targets[1, i], targets[2, i]
                    if walled:
                        six = add_up_at_wall(
                            blob, False, angular, False, x, y, z, sources, g, room, wall, e2
                        )
                    else:
                        six = add_up(blob, False, angular, False, x, y, z, sources, g, e2)
                    for c in range(out.shape[0]):
                        out[c, i] += scale * six[c]

    return group_sum


# Globals, so that parts may call them and still be read from Numba's cache.
SPATIAL_7, SPATIAL_9 = (_fast_sum(False, blob, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))
PLANAR_7, PLANAR_9 = (_fast_sum(False, blob, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
FLOW_7, FLOW_9 = (_group_sum(False, blob, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))
TURNING_7, TURNING_9 = (_group_sum(False, blob, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
WALL_SPATIAL_7, WALL_SPATIAL_9 = (_fast_sum(True, blob, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))
WALL_PLANAR_7, WALL_PLANAR_9 = (_fast_sum(True, blob, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
WALL_FLOW_7, WALL_FLOW_9 = (_group_sum(True, blob, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))
WALL_TURNING_7, WALL_TURNING_9 = (_group_sum(True, blob, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
