"""The M-body sums (32), (33): velocities at targets from point forces and torques at sources.

With r = x - X_k, point force g_k and point torque m_k on the fluid,

    u(x) = 1/mu sum_k [ g H1 + (g.r) r H2 + 1/2 (m x r) Q ]                         (61)
    w(x) = 1/mu sum_k [ 1/2 (g x r) Q + 1/4 m D1 + 1/4 (m.r) r D2 ]                 (66)
    p(x) =      sum_k (g.r) Q                                                       (62)

Threads share out the targets; the sum over sources is serial in each, so the result does not
depend on the number of threads. One loop is specialised at compile time for the blob, for targets
that do not need w, and for a plane of constant x, where g_x = m_y = m_z = 0 and only u_y, u_z, w_x
are not 0: the lines under ``if not planar`` are what the third dimension adds. What a scene does
not use is never compiled.

The kernels take (targets, sources, loads, epsilon, viscosity, out) and add to ``out``, as all flows
do: targets (3, T), sources (3, N), loads (6, N) with g in rows 0-2 and m in rows 3-5; out (6, T):
u in rows 0-2, w in rows 3-5, or (3, T) without w; all C-contiguous.
"""

import math
from functools import lru_cache

from numba import prange

from rodsim.compiled.flags import inline, parallel_kernel
from rodsim.compiled.kernels import pair_sum, part
from rodsim.compiled.wide import WIDE, inverse_root, unit_of, whole_vectors
from rodsim.flows.blobs import (
    ALGEBRAIC7,
    ALGEBRAIC9,
    dipole_scalars,
    inverse_distance,
    stokeslet_scalars,
)
from rodsim.flows.sources import points_of_rods

EIGHT_PI = 8.0 * math.pi


@inline
def squared(planar, r):
    """Return r^2, of r_y and r_z alone where all are in one plane."""
    rx, ry, rz = r
    r2 = ry * ry + rz * rz
    if not planar:
        r2 += rx * rx
    return r2


@inline
def add_pair(blob, planar, angular, r, g, m, inverse, e2, sums):
    """Return ``sums``, 8 pi mu (u, w), and what a source adds that has g, m and is r away.

    ``inverse`` is 1/R. Constants, ``blob``, ``planar``, ``angular``, choose what is compiled.
    """
    rx, ry, rz = r
    gx, gy, gz = g
    mx, my, mz = m
    ux, uy, uz, wx, wy, wz = sums
    gr = gy * ry + gz * rz
    if not planar:
        gr += gx * rx
    h1, h2, q = stokeslet_scalars(blob, inverse, e2)
    along = h2 * gr
    q *= 0.5
    uy += gy * h1 + along * ry - q * (mx * rz)
    uz += gz * h1 + along * rz + q * (mx * ry)
    if not planar:
        ux += gx * h1 + along * rx + q * (my * rz - mz * ry)
        uy += q * (mz * rx)
        uz -= q * (my * rx)
    if angular:
        d1, d2 = dipole_scalars(blob, inverse, e2)
        d1 *= 0.25
        wx += q * (gy * rz - gz * ry) + d1 * mx
        if not planar:
            axial = 0.25 * d2 * (mx * rx + my * ry + mz * rz)
            wx += axial * rx
            wy += q * (gz * rx - gx * rz) + d1 * my + axial * ry
            wz += q * (gx * ry - gy * rx) + d1 * mz + axial * rz
    return ux, uy, uz, wx, wy, wz


@inline
def add_up(blob, planar, angular, wide, x, y, z, sources, loads, e2):
    """Return 8 pi mu (u, w) at one target, from all sources; constants choose the sum.

    ``wide``: 1/R by :mod:`rodsim.compiled.wide`. The last bits depend on the order in which a
    source is read.
    """
    sums = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for k in range(sources.shape[1]):
        ry, rz = y - sources[1, k], z - sources[2, k]
        gy, gz, mx = loads[1, k], loads[2, k], loads[3, k]
        rx, gx, my, mz = x - sources[0, k], loads[0, k], loads[4, k], loads[5, k]
        r, g, m = (rx, ry, rz), (gx, gy, gz), (mx, my, mz)
        r2 = squared(planar, r)
        inverse = inverse_root(r2 + e2) if wide else inverse_distance(r2, e2)
        sums = add_pair(blob, planar, angular, r, g, m, inverse, e2, sums)
    return sums


def _sum(blob, planar, angular):
    """Make the sum of a blob: for any scene or a planar one, with or without w."""

    @parallel_kernel
    def fused_sum(targets, sources, loads, epsilon, viscosity, out):
        unit = 1.0
        if WIDE:
            unit = unit_of(epsilon)
            sources, loads = whole_vectors(sources, loads, unit)
        e2 = unit * epsilon * (unit * epsilon)
        scale = unit / (EIGHT_PI * viscosity)
        for i in prange(targets.shape[1]):
            x, y, z = unit * targets[0, i], unit * targets[1, i], unit * targets[2, i]
            six = add_up(blob, planar, angular, WIDE, x, y, z, sources, loads, e2)
            ux, uy, uz, wx, wy, wz = six
            out[0, i] += scale * ux
            out[1, i] += scale * uy
            out[2, i] += scale * uz
            if angular:
                out[3, i] += unit * scale * wx
                out[4, i] += unit * scale * wy
                out[5, i] += unit * scale * wz

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
    """Make the part that moves the rods; ``fixed`` is (epsilon, viscosity)."""
    seven = blob == ALGEBRAIC7

    @part
    def move_rods(row, fixed, rods, state, loads, velocities):
        points = state[0]
        if planar:
            if seven:
                PLANAR_7(points, points, loads, fixed[0], fixed[1], velocities[0])
            else:
                PLANAR_9(points, points, loads, fixed[0], fixed[1], velocities[0])
        elif seven:
            SPATIAL_7(points, points, loads, fixed[0], fixed[1], velocities[0])
        else:
            SPATIAL_9(points, points, loads, fixed[0], fixed[1], velocities[0])

    return move_rods


def _tracers_part(blob):
    """Make the part that moves tracers; ``fixed`` is (epsilon, viscosity)."""
    seven = blob == ALGEBRAIC7

    @part
    def move_tracers(row, fixed, rods, state, loads, velocities):
        sources, theirs = points_of_rods(rods, state[0], loads)
        if seven:
            FLOW_7(state[2], sources, theirs, fixed[0], fixed[1], velocities[1])
        else:
            FLOW_9(state[2], sources, theirs, fixed[0], fixed[1], velocities[1])

    return move_tracers


spatial_7, spatial_9 = (_rods_part(blob, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))
planar_7, planar_9 = (_rods_part(blob, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
tracers_7, tracers_9 = (_tracers_part(blob) for blob in (ALGEBRAIC7, ALGEBRAIC9))


def _pair_sum(blob, angular):
    """Make the sum that parts call by address, with or without w; ``wall`` is not used."""
    seven = blob == ALGEBRAIC7

    @pair_sum
    def add(targets, sources, loads, epsilon, viscosity, wall, out):
        if angular:
            if seven:
                SPATIAL_7(targets, sources, loads, epsilon, viscosity, out)
            else:
                SPATIAL_9(targets, sources, loads, epsilon, viscosity, out)
        elif seven:
            FLOW_7(targets, sources, loads, epsilon, viscosity, out)
        else:
            FLOW_9(targets, sources, loads, epsilon, viscosity, out)

    return add


sum_7, sum_9 = (_pair_sum(blob, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
sum_u_7, sum_u_9 = (_pair_sum(blob, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))


@lru_cache
def pressure_kernel(blob):
    """Compile ``kernel(targets, sources, loads, epsilon, out)`` with out (T,), eq. (62)."""

    @parallel_kernel
    def pressure_sum(targets, sources, loads, epsilon, out):
        e2 = epsilon * epsilon
        for i in prange(targets.shape[1]):
            x, y, z = targets[0, i], targets[1, i], targets[2, i]
            total = 0.0
            for k in range(sources.shape[1]):
                rx, ry, rz = x - sources[0, k], y - sources[1, k], z - sources[2, k]
                inverse = inverse_distance(rx * rx + ry * ry + rz * rz, e2)
                _, _, q = stokeslet_scalars(blob, inverse, e2)
                total += q * (loads[0, k] * rx + loads[1, k] * ry + loads[2, k] * rz)
            out[i] = total / EIGHT_PI

    return pressure_sum
