"""The sums of ``free.py`` by arcs: far ones from proxies to proxies, near ones as they are.

The exact sum is u = K g; here u = P^T K P g over far pairs of arcs and K g over near ones, with the
same kernel K. Threads share out the arcs; all inside of one is serial, in an order that the lists
fix, so the result does not depend on the number of threads.
"""

from numba import prange

from rodsim.compiled.flags import inline, threaded_kernel, unsigned
from rodsim.compiled.kernels import part
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
    WEIGHTS,
    floats,
    integers,
    rows,
    work,
)
from rodsim.flows.fast.passes import add_own, copy_sources, down, room_for, up
from rodsim.flows.free import EIGHT_PI, add_up


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


@inline
def _act(blob, planar, nodes, a, partners, first, count, places, loads, e2, scale, out):
    """Add the sums over the sources of some arcs at those of arc a: its points, or its proxies."""
    sources, g = room_for(_total(nodes, partners, count))
    _gather(nodes, partners, first, count, places, loads, sources, g, 0)
    for i in range(nodes[a, first], nodes[a, first] + nodes[a, count]):
        x, y, z = places[0, i], places[1, i], places[2, i]
        six = add_up(blob, planar, True, x, y, z, sources, g, e2)
        for c in range(6):
            out[c, i] += scale * six[c]


def _fast_sum(blob, planar):
    """Make the whole sum of a blob, for any scene or a planar one."""

    @threaded_kernel
    def fast_sum(fixed, points, loads, sampled, out):
        e2 = fixed[EPSILON] * fixed[EPSILON]
        scale = 1.0 / (EIGHT_PI * fixed[VISCOSITY])
        nodes, weights = rows(fixed, NODES, 6), floats(fixed, WEIGHTS)
        arcs = nodes, integers(fixed, SLOTS), weights, rows(fixed, CHUNKS, 2), integers(fixed, TOPS)
        places, shared, far = up(*arcs, points, loads)
        for near in range(2):
            # First all proxies act on proxies; then all points on points, and the far adds to them.
            if near:
                down(*arcs, scale, far, out)
                add_own(loads, fixed[OWN_FORCE], fixed[OWN_TORQUE], out)
                at, g, to, first, count, factor = points, loads, out, LO, COUNT, scale
                order, shares = work(fixed, SAMPLE_NEAR if sampled else NEAR_WORK)
                begins, partners = integers(fixed, NEAR_BEGINS), integers(fixed, NEAR)
            else:
                at, g, to, first, count, factor = places, shared, far, START, PROXIES, 1.0
                order, shares = work(fixed, SAMPLE_FAR if sampled else FAR_WORK)
                begins, partners = integers(fixed, FAR_BEGINS), integers(fixed, FAR)
            for share in prange(shares.size - 1):
                for k in range(shares[share], shares[share + 1]):
                    a = order[k]
                    others = partners[begins[a] : begins[a + 1]]
                    _act(blob, planar, nodes, a, others, first, count, at, g, e2, factor, to)

    return fast_sum


def _group_sum(blob, angular):
    """Make the sum of a blob at targets in groups, with or without w."""

    @threaded_kernel
    def group_sum(fixed, targets, points, loads, sampled, out):
        e2 = fixed[EPSILON] * fixed[EPSILON]
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
                end = _gather(nodes, afar, START, PROXIES, places, shared, sources, g, 0)
                _gather(nodes, close, LO, COUNT, points, loads, sources, g, end)
                for t in range(members[a], members[a + 1]):
                    i = order[t]
                    x, y, z = targets[0, i], targets[1, i], targets[2, i]
                    six = add_up(blob, False, angular, x, y, z, sources, g, e2)
                    for c in range(out.shape[0]):
                        out[c, i] += scale * six[c]

    return group_sum


SPATIAL_7, SPATIAL_9 = (_fast_sum(blob, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))
PLANAR_7, PLANAR_9 = (_fast_sum(blob, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
FLOW_7, FLOW_9 = (_group_sum(blob, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))
TURNING_7, TURNING_9 = (_group_sum(blob, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))


def sum_kernel(blob, planar=False):
    """Return ``kernel(fixed, points, loads, sampled, out)`` at the sources themselves."""
    if planar:
        return PLANAR_7 if blob == ALGEBRAIC7 else PLANAR_9
    return SPATIAL_7 if blob == ALGEBRAIC7 else SPATIAL_9


def group_kernel(blob, angular=False):
    """Return ``kernel(fixed, targets, points, loads, sampled, out)``, with w where asked for."""
    if angular:
        return TURNING_7 if blob == ALGEBRAIC7 else TURNING_9
    return FLOW_7 if blob == ALGEBRAIC7 else FLOW_9


def _rods_part(blob, planar):
    """Make the part that moves the rods; ``fixed`` as of :mod:`rodsim.flows.fast.packed`."""
    seven = blob == ALGEBRAIC7

    @part
    def move_rods(row, fixed, rods, state, loads, velocities):
        if planar:
            if seven:
                PLANAR_7(fixed, state[0], loads, False, velocities[0])
            else:
                PLANAR_9(fixed, state[0], loads, False, velocities[0])
        elif seven:
            SPATIAL_7(fixed, state[0], loads, False, velocities[0])
        else:
            SPATIAL_9(fixed, state[0], loads, False, velocities[0])

    return move_rods


def _tracers_part(blob):
    """Make the part that moves tracers."""
    seven = blob == ALGEBRAIC7

    @part
    def move_tracers(row, fixed, rods, state, loads, velocities):
        if seven:
            FLOW_7(fixed, state[2], state[0], loads, False, velocities[1])
        else:
            FLOW_9(fixed, state[2], state[0], loads, False, velocities[1])

    return move_tracers


spatial_7, spatial_9 = (_rods_part(blob, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))
planar_7, planar_9 = (_rods_part(blob, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
tracers_7, tracers_9 = (_tracers_part(blob) for blob in (ALGEBRAIC7, ALGEBRAIC9))
