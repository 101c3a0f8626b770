"""Rod and grid: the delta function (38), force and torque spread (37c), velocities interpolated.

c = h, the spacing of the grid, as in all of the paper's computations. The curls of (37c) and (37e)
are central differences on the grid. Moved onto the delta function they cost nothing: with d the
central difference of delta_c,

    f(x) = sum_k [g_k delta + 1/2 d x m_k],   U_k = h^3 sum u delta,   W_k = -1/2 h^3 sum d x u,

so spreading and interpolation are each other's transpose: h^3 sum f.u = sum (g.U + m.W).
"""

import math

import numpy as np
from numba import prange

from rodsim.compiled.flags import inline, kernel, parallel_kernel

WIDTH = 6  # grid points a side that a point of a rod can reach: 4 of delta_c, one more for d


@inline
def bell(r):
    """Return phi(r) of (38), zero beyond 2."""
    a = abs(r)
    if a <= 1.0:
        return 0.125 * (3.0 - 2.0 * a + math.sqrt(1.0 + 4.0 * a - 4.0 * a * a))
    if a <= 2.0:
        return 0.125 * (5.0 - 2.0 * a - math.sqrt(max(0.0, -7.0 + 12.0 * a - 4.0 * a * a)))
    return 0.0


@inline
def _weigh(X, k, h, n, place, weight, slope):
    """Write the grid points (3, 6) round point k, their phi, and its central difference."""
    for a in range(3):
        at = X[a, k] / h
        first = math.floor(at) - 2
        for i in range(WIDTH):
            place[a, i] = (first + i) % n
            weight[a, i] = bell(at - (first + i))
        for i in range(WIDTH):
            after = weight[a, i + 1] if i + 1 < WIDTH else 0.0
            before = weight[a, i - 1] if i > 0 else 0.0
            slope[a, i] = 0.5 * (after - before) / h


@kernel
def spread(X, loads, h, force):
    """Add to ``force`` (3, n, n, n) the loads (6, N), g over m, of points X (3, N); (37c)."""
    n, density = force.shape[1], 1.0 / h**3
    place, weight = np.empty((3, WIDTH), np.int64), np.empty((3, WIDTH))
    slope = np.empty((3, WIDTH))
    for k in range(X.shape[1]):
        _weigh(X, k, h, n, place, weight, slope)
        gx, gy, gz = loads[0, k] * density, loads[1, k] * density, loads[2, k] * density
        mx, my, mz = loads[3, k] * density, loads[4, k] * density, loads[5, k] * density
        mx, my, mz = 0.5 * mx, 0.5 * my, 0.5 * mz
        for i in range(WIDTH):
            for j in range(WIDTH):
                both = weight[0, i] * weight[1, j]
                first, second = slope[0, i] * weight[1, j], weight[0, i] * slope[1, j]
                for m in range(WIDTH):
                    x, y, z = place[0, i], place[1, j], place[2, m]
                    delta, dz = both * weight[2, m], both * slope[2, m]
                    dx, dy = first * weight[2, m], second * weight[2, m]
                    force[0, x, y, z] += gx * delta + dy * mz - dz * my
                    force[1, x, y, z] += gy * delta + dz * mx - dx * mz
                    force[2, x, y, z] += gz * delta + dx * my - dy * mx


@parallel_kernel
def interpolate(X, velocity, h, rates):
    """Write U over W (6, N) of points X (3, N) in a velocity (3, n, n, n); (37d), (37e)."""
    n = velocity.shape[1]
    for k in prange(X.shape[1]):
        place, weight = np.empty((3, WIDTH), np.int64), np.empty((3, WIDTH))
        slope = np.empty((3, WIDTH))
        _weigh(X, k, h, n, place, weight, slope)
        ux, uy, uz, wx, wy, wz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for i in range(WIDTH):
            for j in range(WIDTH):
                both = weight[0, i] * weight[1, j]
                first, second = slope[0, i] * weight[1, j], weight[0, i] * slope[1, j]
                for m in range(WIDTH):
                    x, y, z = place[0, i], place[1, j], place[2, m]
                    vx, vy, vz = velocity[0, x, y, z], velocity[1, x, y, z], velocity[2, x, y, z]
                    delta, dz = both * weight[2, m], both * slope[2, m]
                    dx, dy = first * weight[2, m], second * weight[2, m]
                    ux, uy, uz = ux + vx * delta, uy + vy * delta, uz + vz * delta
                    wx, wy, wz = (
                        wx - 0.5 * (dy * vz - dz * vy),
                        wy - 0.5 * (dz * vx - dx * vz),
                        wz - 0.5 * (dx * vy - dy * vx),
                    )
        rates[0, k], rates[1, k], rates[2, k] = ux, uy, uz
        rates[3, k], rates[4, k], rates[5, k] = wx, wy, wz
