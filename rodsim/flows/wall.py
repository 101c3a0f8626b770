"""The sums of ``free.py`` above a plane wall on which the fluid does not slip: z = ``wall``.

Each source has an image below the wall: :mod:`rodsim.flows.images` has the formulas. Heights below
0 give smooth, meaningless numbers: callers keep them out.

Arguments and variants are as there.
"""

import math
from functools import lru_cache

import numpy as np
from numba import prange

from rodsim.compiled.flags import parallel_kernel
from rodsim.compiled.kernels import run_of_sum
from rodsim.compiled.wide import WIDE, unit_of, whole_vectors
from rodsim.flows.blobs import (
    ALGEBRAIC7,
    ALGEBRAIC9,
    image_scalars,
    inverse_distance,
    stokeslet_scalars,
)
from rodsim.flows.images import add_up

EIGHT_PI = 8.0 * math.pi


def _sum(blob, planar, angular):
    """Make the sum of a blob: for any scene or a planar one, with or without w."""

    @run_of_sum
    def add(begin, end, targets, sources, loads, epsilon, viscosity, wall, out):
        unit = 1.0
        if WIDE:
            unit = unit_of(epsilon)
            sources, loads = whole_vectors(sources, loads, unit)
        e2, height = unit * epsilon * (unit * epsilon), unit * wall
        scale, inverses = unit / (EIGHT_PI * viscosity), np.empty((2, sources.shape[1]))
        for i in range(np.uint64(begin), np.uint64(end)):
            x, y, z = unit * targets[0, i], unit * targets[1, i], unit * targets[2, i]
            six = add_up(blob, planar, angular, WIDE, x, y, z, sources, loads, inverses, height, e2)
            for c in range(3):
                out[c, i] += scale * six[c]
            for c in range(3, out.shape[0]):
                out[c, i] += unit * scale * six[c]

    return add


spatial_7, spatial_9 = (_sum(blob, False, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
planar_7, planar_9 = (_sum(blob, True, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
flow_7, flow_9 = (_sum(blob, False, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))


@lru_cache
def pressure_kernel(blob):
    """Compile ``kernel(targets, sources, loads, epsilon, wall, out)`` with out (T,)."""

    @parallel_kernel
    def pressure_sum(targets, sources, loads, epsilon, wall, out):
        e2 = epsilon * epsilon
        for i in prange(targets.shape[1]):
            x, y, z = targets[0, i], targets[1, i], targets[2, i] - wall
            total = 0.0
            for k in range(sources.shape[1]):
                h = sources[2, k] - wall
                rx, ry, d, s = x - sources[0, k], y - sources[1, k], z - h, z + h
                gx, gy, gz = loads[0, k], loads[1, k], loads[2, k]
                r2 = rx * rx + ry * ry + d * d
                image = inverse_distance(r2 + 4.0 * z * h, e2)
                _, _, q = stokeslet_scalars(blob, inverse_distance(r2, e2), e2)
                _, _, q_image = stokeslet_scalars(blob, image, e2)
                p, _, e1, _ = image_scalars(blob, image, e2)
                ar = (h * gx + loads[4, k]) * rx + (h * gy - loads[3, k]) * ry - h * gz * s
                total += (q - q_image) * (gx * rx + gy * ry + gz * d)
                total += s * (e1 - 2.0 * p) * ar
            out[i] += total / (0.5 * EIGHT_PI)

    return pressure_sum
