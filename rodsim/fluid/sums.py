"""The M-body sums (32), (33): velocities at targets from point forces and torques at sources.

With r = x - X_k, point force g_k and point torque m_k on the fluid,

    u(x) = 1/mu sum_k [ g H1 + (g.r) r H2 + 1/2 (m x r) Q ]                         (61)
    w(x) = 1/mu sum_k [ 1/2 (g x r) Q + 1/4 m D1 + 1/4 (m.r) r D2 ]                 (66)
    p(x) =      sum_k (g.r) Q                                                       (62)

Threads share out the targets; the sum over sources is serial in each, so the result does not
depend on the number of threads. The loops are specialised at compile time for the blob and for
targets that do not need w; a planar scene has a loop of its own, over what is not 0 there. What a
scene does not use is never compiled.

The kernels take (targets, sources, loads, epsilon, viscosity, out): targets (3, T), sources (3, N),
loads (6, N) with g in rows 0-2 and m in rows 3-5; out (6, T): u in rows 0-2, w in rows 3-5, or
(3, T) without w; all C-contiguous.
"""

import math
from functools import lru_cache

from numba import prange

from rodsim.fluid.blobs import ALGEBRAIC7, ALGEBRAIC9, dipole_scalars, stokeslet_scalars
from rodsim.jit import parallel_kernel

EIGHT_PI = 8.0 * math.pi


def _spatial_kernel(blob, angular):
    """Make the sum for any scene, with or without w."""

    @parallel_kernel
    def spatial_sum(targets, sources, loads, epsilon, viscosity, out):
        e2 = epsilon * epsilon
        scale = 1.0 / (EIGHT_PI * viscosity)
        for i in prange(targets.shape[1]):
            x, y, z = targets[0, i], targets[1, i], targets[2, i]
            ux, uy, uz, wx, wy, wz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for k in range(sources.shape[1]):
                rx, ry, rz = x - sources[0, k], y - sources[1, k], z - sources[2, k]
                gx, gy, gz = loads[0, k], loads[1, k], loads[2, k]
                mx, my, mz = loads[3, k], loads[4, k], loads[5, k]
                r2 = rx * rx + ry * ry + rz * rz
                h1, h2, q = stokeslet_scalars(blob, r2, e2)
                along = h2 * (gx * rx + gy * ry + gz * rz)
                q *= 0.5
                ux += gx * h1 + along * rx + q * (my * rz - mz * ry)
                uy += gy * h1 + along * ry + q * (mz * rx - mx * rz)
                uz += gz * h1 + along * rz + q * (mx * ry - my * rx)
                if angular:
                    d1, d2 = dipole_scalars(blob, r2, e2)
                    d1 *= 0.25
                    axial = 0.25 * d2 * (mx * rx + my * ry + mz * rz)
                    wx += q * (gy * rz - gz * ry) + d1 * mx + axial * rx
                    wy += q * (gz * rx - gx * rz) + d1 * my + axial * ry
                    wz += q * (gx * ry - gy * rx) + d1 * mz + axial * rz
            out[0, i], out[1, i], out[2, i] = scale * ux, scale * uy, scale * uz
            if angular:
                out[3, i], out[4, i], out[5, i] = scale * wx, scale * wy, scale * wz

    return spatial_sum


def _planar_kernel(blob):
    """Make the sum for a plane of constant x, g_x = m_y = m_z = 0: only u_y, u_z, w_x are not 0."""

    @parallel_kernel
    def planar_sum(targets, sources, loads, epsilon, viscosity, out):
        e2 = epsilon * epsilon
        scale = 1.0 / (EIGHT_PI * viscosity)
        for i in prange(targets.shape[1]):
            y, z = targets[1, i], targets[2, i]
            uy, uz, wx = 0.0, 0.0, 0.0
            for k in range(sources.shape[1]):
                ry, rz = y - sources[1, k], z - sources[2, k]
                gy, gz, mx = loads[1, k], loads[2, k], loads[3, k]
                r2 = ry * ry + rz * rz
                h1, h2, q = stokeslet_scalars(blob, r2, e2)
                along = h2 * (gy * ry + gz * rz)
                q *= 0.5
                uy += gy * h1 + along * ry - q * mx * rz
                uz += gz * h1 + along * rz + q * mx * ry
                d1, _ = dipole_scalars(blob, r2, e2)
                wx += q * (gy * rz - gz * ry) + 0.25 * d1 * mx
            out[0, i], out[1, i], out[2, i] = 0.0, scale * uy, scale * uz
            out[3, i], out[4, i], out[5, i] = scale * wx, 0.0, 0.0

    return planar_sum


# Globals, so that compiled functions may call them and still be read from Numba's cache.
SPATIAL_7, SPATIAL_9 = (_spatial_kernel(blob, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
PLANAR_7, PLANAR_9 = (_planar_kernel(blob) for blob in (ALGEBRAIC7, ALGEBRAIC9))
FLOW_7, FLOW_9 = (_spatial_kernel(blob, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))


def velocity_kernel(blob, planar=False, angular=True):
    """Return the kernel for a blob: of a planar scene, or for targets that do not need w."""
    if not angular:
        return FLOW_7 if blob == ALGEBRAIC7 else FLOW_9
    if planar:
        return PLANAR_7 if blob == ALGEBRAIC7 else PLANAR_9
    return SPATIAL_7 if blob == ALGEBRAIC7 else SPATIAL_9


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
                _, _, q = stokeslet_scalars(blob, rx * rx + ry * ry + rz * rz, e2)
                total += q * (loads[0, k] * rx + loads[1, k] * ry + loads[2, k] * rz)
            out[i] = total / EIGHT_PI

    return pressure_sum
