"""The sums of ``free.py`` above a plane wall on which the fluid does not slip: z = ``wall_height``.

Each source has an image below the wall (Blake 1971; regularized by Ainley et al. 2008 for
algebraic7, here for both blobs: docs/method.md). With z and h the heights of target and source
above the wall, r = x - X, r* = x - X*, X* the mirror image of X, a star on a scalar for its value
at R*^2 = R^2 + 4 z h, and g', m' for g, m with the third component reversed:

    v = E* a + P* (a.r*) r*,   a = h g' + m x e3
    mu u = (H1 - H1* - 2 z h H2*) g + (H2 - H2*) (g.r) r + 1/2 (Q - Q*) m x r
           - 2 z v - z h E1* m' x r*
    mu w = 1/2 (Q - Q*) g x r - 2 e3 x v - z h E1* r* x g' + 1/4 D1 m + 1/4 D2 (m.r) r
           + kappa [(m'.r*) r* - r*^2 m'] - 1/2 Q* m - z h E1* m' + (E* - 1/2 (z + h)^2 E1*) m_p
           + 1/2 E1* [(m.q) q + z (m.r_p) e3 - h m_3 r_p]
    p    = (Q - Q*) (g.r) + 2 (z + h) (E1* - 2 P*) (a.r*)

summed over the sources, with kappa = 1/4 (2 z h E2* - 2 P* + E1*), r_p and m_p the parts of r and m
along the wall, q = e3 x r. On the wall R* = R: every term of u is exactly 0. The mobility of two
points is symmetric. Heights below 0 give smooth, meaningless numbers: callers keep them out.

The kernels are those of ``free.py`` with ``wall_height`` before ``out``, to which they add; threads
and variants are as there. Two passes over the sources, first all distances of a target and then its
sum, are faster than one (docs/notes/performance.md).
"""

import math
from functools import lru_cache

import numpy as np
from numba import prange

from rodsim.compiled.constants import ON_WALL
from rodsim.compiled.flags import inline, parallel_kernel
from rodsim.compiled.kernels import pair_sum, part
from rodsim.flows.blobs import (
    ALGEBRAIC7,
    ALGEBRAIC9,
    dipole_scalars,
    image_scalars,
    inverse_distance,
    stokeslet_scalars,
)
from rodsim.flows.sources import points_of_rods

EIGHT_PI = 8.0 * math.pi


@inline
def _inverse_distances(x, y, z, sources, wall_height, e2, inverses):
    """Fill ``inverses`` with 1/R and 1/R* of all sources: one division for both."""
    for k in range(sources.shape[1]):
        h = sources[2, k] - wall_height
        rx, ry, d = x - sources[0, k], y - sources[1, k], z - h
        r2 = rx * rx + ry * ry + d * d + e2
        direct, image = math.sqrt(r2), math.sqrt(r2 + 4.0 * z * h)
        both = 1.0 / (direct * image)
        inverses[0, k], inverses[1, k] = image * both, direct * both


@inline
def _force_scalars(blob, inverse, image, zh, e2):
    """Return H1 - H1* - 2 z h H2*, H2 - H2* and (Q - Q*)/2, all exactly 0 on the wall."""
    h1, h2, q = stokeslet_scalars(blob, inverse, e2)
    h1_image, h2_image, q_image = stokeslet_scalars(blob, image, e2)
    return (h1 - h1_image) - 2.0 * zh * h2_image, h2 - h2_image, 0.5 * (q - q_image)


@inline
def _torque_scalars(blob, inverse, image, zh, e2):
    """Return D1/4 - Q*/2, D2/4 and kappa = (2 z h E2* - 2 P* + E1*)/4: of w made by torques."""
    d1, d2 = dipole_scalars(blob, inverse, e2)
    _, _, q_image = stokeslet_scalars(blob, image, e2)
    p, _, e1, e_2 = image_scalars(blob, image, e2)
    return 0.25 * d1 - 0.5 * q_image, 0.25 * d2, 0.5 * (zh * e_2 - p) + 0.25 * e1


def _sum(blob, planar, angular):
    """Make the sum of a blob: for any scene or a planar one, with or without w."""

    @parallel_kernel
    def fused_sum(targets, sources, loads, epsilon, viscosity, wall_height, out):
        e2 = epsilon * epsilon
        scale = 1.0 / (EIGHT_PI * viscosity)
        for i in prange(targets.shape[1]):
            x, y, z = targets[0, i], targets[1, i], targets[2, i] - wall_height
            inverses = np.empty((2, sources.shape[1]))
            _inverse_distances(x, y, z, sources, wall_height, e2, inverses)
            ux, uy, uz, wx, wy, wz, vx, vy, vz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for k in range(sources.shape[1]):
                # Products of vectors: g.r, a.r*, and mr = e3 . (m x r).
                h = sources[2, k] - wall_height
                ry, d, s = y - sources[1, k], z - h, z + h
                gy, gz, mx = loads[1, k], loads[2, k], loads[3, k]
                ay, az = h * gy - mx, -h * gz
                gr, ar, mr = gy * ry + gz * d, ay * ry + az * s, mx * ry
                if not planar:
                    rx = x - sources[0, k]
                    gx, my, mz = loads[0, k], loads[4, k], loads[5, k]
                    ax = h * gx + my
                    gr, ar, mr = gr + gx * rx, ar + ax * rx, mr - my * rx
                # u, and v, which u and w share.
                zh, inverse, image = z * h, inverses[0, k], inverses[1, k]
                h1, h2, q = _force_scalars(blob, inverse, image, zh, e2)
                p, e, e1, _ = image_scalars(blob, image, e2)
                along, back, c = h2 * gr, p * ar, zh * e1
                uy += gy * h1 + along * ry - mx * (q * d - c * s)
                uz += gz * h1 + along * d + (q - c) * mr
                vy += e * ay + back * ry
                vz += e * az + back * s
                if not planar:
                    ux += gx * h1 + along * rx + my * (q * d - c * s) - mz * ry * (q + c)
                    uy += mz * rx * (q + c)
                    vx += e * ax + back * rx
                # w but for v; s2 = r*^2, and mrho = m.r without the third component.
                if angular:
                    d1, d2, kappa = _torque_scalars(blob, inverse, image, zh, e2)
                    e1 *= 0.5
                    s2, turn = ry * ry + d * d + 4.0 * zh, e1 * mr
                    if not planar:
                        s2 += rx * rx
                    own = d1 - kappa * s2 - e1 * (s * s) - c + e
                    wx += gy * (q * d + c * s) - gz * ry * (q - c) + turn * ry + own * mx
                    if not planar:
                        mrho = mx * rx + my * ry
                        axial, mirrored = d2 * (mrho + mz * d), kappa * (mrho - mz * s)
                        lead = axial + mirrored - e1 * (h * mz)
                        wx += lead * rx
                        wy += gz * rx * (q - c) - gx * (q * d + c * s) - turn * rx + own * my
                        wy += lead * ry
                        wz += (gx * ry - gy * rx) * (q + c) + axial * d + mirrored * s
                        wz += e1 * (z * mrho) + (d1 + kappa * s2 + c) * mz
            out[0, i] += scale * (ux - 2.0 * z * vx)
            out[1, i] += scale * (uy - 2.0 * z * vy)
            out[2, i] += scale * (uz - 2.0 * z * vz)
            if angular:
                out[3, i] += scale * (wx + 2.0 * vy)
                out[4, i] += scale * (wy - 2.0 * vx)
                out[5, i] += scale * wz

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


def _rods_part(blob, planar):
    """Make the part that moves the rods; ``fixed`` is (epsilon, viscosity, wall height)."""
    seven = blob == ALGEBRAIC7

    @part
    def move_rods(row, fixed, rods, state, loads, velocities):
        points, out = state[0], velocities[0]
        epsilon, viscosity, height = fixed[0], fixed[1], fixed[2]
        for k in range(points.shape[1]):
            if points[2, k] <= height:
                out[:] = np.nan  # no fluid there: the step is rejected
                return
        if planar:
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
    """Make the part that moves tracers; those below the wall are nowhere: NaN."""
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
        for i in range(points.shape[1]):
            if points[2, i] < height - ON_WALL * epsilon:
                out[:, i] = np.nan

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
