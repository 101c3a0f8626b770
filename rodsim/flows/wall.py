"""The sums of ``free.py`` above a plane wall on which the fluid does not slip: z = ``wall_height``.

Each source has an image below the wall: :mod:`rodsim.flows.images` has the formulas. Heights below
0 give smooth, meaningless numbers: callers keep them out.

The kernels are those of ``free.py`` with ``wall_height`` before ``out``, to which they add; threads
and variants are as there.
"""

import math
from functools import lru_cache

import numpy as np
from numba import prange

from rodsim.compiled.constants import ON_WALL
from rodsim.compiled.flags import parallel_kernel, unsigned
from rodsim.compiled.kernels import pair_sum, part
from rodsim.compiled.wide import WIDE, unit_of, whole_vectors
from rodsim.flows.blobs import (
    ALGEBRAIC7,
    ALGEBRAIC9,
    image_scalars,
    inverse_distance,
    stokeslet_scalars,
)
from rodsim.flows.images import add_up
from rodsim.flows.sources import points_of_rods

EIGHT_PI = 8.0 * math.pi


def _sum(blob, planar, angular):
    """Make the sum of a blob: for any scene or a planar one, with or without w."""

    @parallel_kernel
    def fused_sum(targets, sources, loads, epsilon, viscosity, wall_height, out):
        unit = 1.0
        if WIDE:
            unit = unit_of(epsilon)
            sources, loads = whole_vectors(sources, loads, unit)
        e2, height = unit * epsilon * (unit * epsilon), unit * wall_height
        scale = unit / (EIGHT_PI * viscosity)
        for i in prange(targets.shape[1]):
            x, y, z = unit * targets[0, i], unit * targets[1, i], unit * targets[2, i]
            six = add_up(blob, planar, angular, WIDE, x, y, z, sources, loads, height, e2)
            for c in range(3):
                out[c, i] += scale * six[c]
            for c in range(3, out.shape[0]):
                out[c, i] += unit * scale * six[c]

    return fused_sum


# Globals, so that compiled functions may call them and still be read from Numba's cache.
SPATIAL_7, SPATIAL_9 = (_sum(blob, False, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
PLANAR_7, PLANAR_9 = (_sum(blob, True, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
FLOW_7, FLOW_9 = (_sum(blob, False, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))


def velocity_kernel(blob, planar=False, angular=True):
    """Return the kernel for a blob: of a planar scene, or for targets that do not need w."""
    if not angular:
        return FLOW_7 if blob == ALGEBRAIC7 else FLOW_9
    if planar:
        return PLANAR_7 if blob == ALGEBRAIC7 else PLANAR_9
    return SPATIAL_7 if blob == ALGEBRAIC7 else SPATIAL_9


@unsigned
def touches(points, wall_height):
    """Return whether any of the points (3, N) is at the wall or below it."""
    lowest = math.inf
    for k in range(points.shape[1]):
        lowest = min(lowest, points[2, k])
    return lowest <= wall_height


@unsigned
def drop_below(points, wall_height, epsilon, out):
    """Set velocities (3, T) of points below the wall to NaN: they are nowhere."""
    for i in range(points.shape[1]):
        if points[2, i] < wall_height - ON_WALL * epsilon:
            out[:, i] = np.nan


def _rods_part(blob, planar):
    """Make the part that moves the rods; ``fixed`` is (epsilon, viscosity, wall height)."""
    seven = blob == ALGEBRAIC7

    @part
    def move_rods(row, fixed, rods, state, loads, velocities):
        points, out = state[0], velocities[0]
        epsilon, viscosity, height = fixed[0], fixed[1], fixed[2]
        if touches(points, height):
            out[:] = np.nan  # no fluid there: the step is rejected
        elif planar:
            if seven:
                PLANAR_7(points, points, loads, epsilon, viscosity, height, out)
            else:
                PLANAR_9(points, points, loads, epsilon, viscosity, height, out)
        elif seven:
            SPATIAL_7(points, points, loads, epsilon, viscosity, height, out)
        else:
            SPATIAL_9(points, points, loads, epsilon, viscosity, height, out)

    return move_rods


def _tracers_part(blob):
    """Make the part that moves tracers."""
    seven = blob == ALGEBRAIC7

    @part
    def move_tracers(row, fixed, rods, state, loads, velocities):
        points, out = state[2], velocities[1]
        epsilon, viscosity, height = fixed[0], fixed[1], fixed[2]
        sources, theirs = points_of_rods(rods, state[0], loads)
        if seven:
            FLOW_7(points, sources, theirs, epsilon, viscosity, height, out)
        else:
            FLOW_9(points, sources, theirs, epsilon, viscosity, height, out)
        drop_below(points, height, epsilon, out)

    return move_tracers


spatial_7, spatial_9 = (_rods_part(blob, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))
planar_7, planar_9 = (_rods_part(blob, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
tracers_7, tracers_9 = (_tracers_part(blob) for blob in (ALGEBRAIC7, ALGEBRAIC9))


def _pair_sum(blob, angular):
    """Make the sum that parts call by address, with or without w; ``wall``: height, of the wall."""
    seven = blob == ALGEBRAIC7

    @pair_sum
    def add(targets, sources, loads, epsilon, viscosity, wall, out):
        if angular:
            if seven:
                SPATIAL_7(targets, sources, loads, epsilon, viscosity, wall, out)
            else:
                SPATIAL_9(targets, sources, loads, epsilon, viscosity, wall, out)
        elif seven:
            FLOW_7(targets, sources, loads, epsilon, viscosity, wall, out)
        else:
            FLOW_9(targets, sources, loads, epsilon, viscosity, wall, out)

    return add


sum_7, sum_9 = (_pair_sum(blob, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
sum_u_7, sum_u_9 = (_pair_sum(blob, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))


@lru_cache
def pressure_kernel(blob):
    """Compile ``kernel(targets, sources, loads, epsilon, wall_height, out)`` with out (T,)."""

    @parallel_kernel
    def pressure_sum(targets, sources, loads, epsilon, wall_height, out):
        e2 = epsilon * epsilon
        for i in prange(targets.shape[1]):
            x, y, z = targets[0, i], targets[1, i], targets[2, i] - wall_height
            total = 0.0
            for k in range(sources.shape[1]):
                h = sources[2, k] - wall_height
                rx, ry, d, s = x - sources[0, k], y - sources[1, k], z - h, z + h
                gx, gy, gz = loads[0, k], loads[1, k], loads[2, k]
                r2 = rx * rx + ry * ry + d * d
                image = inverse_distance(r2 + 4.0 * z * h, e2)
                _, _, q = stokeslet_scalars(blob, inverse_distance(r2, e2), e2)
                _, _, q_image = stokeslet_scalars(blob, image, e2)
                p, _, e1, _ = image_scalars(blob, image, e2)
                ar = (h * gx + loads[4, k]) * rx + (h * gy - loads[3, k]) * ry - h * gz * s
                total += (q - q_image) * (gx * rx + gy * ry + gz * d)
                total += 2.0 * s * (e1 - 2.0 * p) * ar
            out[i] += total / EIGHT_PI

    return pressure_sum
