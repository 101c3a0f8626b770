"""The M-body sums (32), (33): velocities at targets from point forces and torques at sources.

With r = x - X_k, point force g_k and point torque m_k on the fluid,

    u(x) = 1/mu sum_k [ g H1 + (g.r) r H2 + 1/2 (m x r) Q ]                         (61)
    w(x) = 1/mu sum_k [ 1/2 (g x r) Q + 1/4 m D1 + 1/4 (m.r) r D2 ]                 (66)
    p(x) =      sum_k (g.r) Q                                                       (62)

One loop is specialised at compile time for the blob, for targets that do not need w, and for a
plane of constant x, where g_x = m_y = m_z = 0 and only u_y, u_z, w_x are not 0: the lines under
``if not planar`` are what the third dimension adds. What a scene does not use is never compiled.

The sums are *runs* of :mod:`rodsim.flows.by_threads`, ``wall`` not used. They add to ``out``, as
all flows do: targets (3, T), sources (3, N), loads (6, N) with g in rows 0-2 and m in rows 3-5;
out (6, T): u in rows 0-2, w in rows 3-5, or (3, T) without w; all C-contiguous.
"""

import math
from functools import lru_cache

import numpy as np
from numba import prange

from rodsim.compiled.flags import inline, parallel_kernel
from rodsim.compiled.kernels import run_of_sum
from rodsim.compiled.wide import WIDE, inverse_root, unit_of, whole_vectors
from rodsim.flows.blobs import (
    ALGEBRAIC7,
    ALGEBRAIC9,
    dipole_scalars,
    inverse_distance,
    stokeslet_scalars,
)

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
    uy += gy * h1 + along * ry - q * (mx * rz)
    uz += gz * h1 + along * rz + q * (mx * ry)
    if not planar:
        ux += gx * h1 + along * rx + q * (my * rz - mz * ry)
        uy += q * (mz * rx)
        uz -= q * (my * rx)
    if angular:
        d1, d2 = dipole_scalars(blob, inverse, e2)
        wx += q * (gy * rz - gz * ry) + d1 * mx
        if not planar:
            axial = d2 * (mx * rx + my * ry + mz * rz)
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

    @run_of_sum
    def add(begin, end, targets, sources, loads, epsilon, viscosity, wall, out):
        unit = 1.0
        if WIDE:
            unit = unit_of(epsilon)
            sources, loads = whole_vectors(sources, loads, unit)
        e2 = unit * epsilon * (unit * epsilon)
        scale = unit / (EIGHT_PI * viscosity)
        for i in range(np.uint64(begin), np.uint64(end)):
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

    return add


spatial_7, spatial_9 = (_sum(blob, False, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
planar_7, planar_9 = (_sum(blob, True, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
flow_7, flow_9 = (_sum(blob, False, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))


@lru_cache
def pressure_kernel(blob):
    """Compile ``kernel(targets, sources, loads, epsilon, wall, out)`` with out (T,), eq. (62)."""

    @parallel_kernel
    def pressure_sum(targets, sources, loads, epsilon, wall, out):
        e2 = epsilon * epsilon
        for i in prange(targets.shape[1]):
            x, y, z = targets[0, i], targets[1, i], targets[2, i]
            total = 0.0
            for k in range(sources.shape[1]):
                rx, ry, rz = x - sources[0, k], y - sources[1, k], z - sources[2, k]
                inverse = inverse_distance(rx * rx + ry * ry + rz * rz, e2)
                _, _, q = stokeslet_scalars(blob, inverse, e2)
                total += q * (loads[0, k] * rx + loads[1, k] * ry + loads[2, k] * rz)
            out[i] = total / (0.5 * EIGHT_PI)

    return pressure_sum
