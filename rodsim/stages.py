"""Evaluations in a compiled loop: the stages of a step without a Python call in between."""

from functools import lru_cache

import numpy as np
from numba import get_num_threads

from rodsim.elasticity import point_loads
from rodsim.fluid.blobs import ALGEBRAIC7
from rodsim.fluid.sums import FLOW_7, FLOW_9, PLANAR_7, PLANAR_9, SPATIAL_7, SPATIAL_9
from rodsim.jit import MAT, SYSTEM, TRIADS, VEC, inline, kernel
from rodsim.rotations import add, rotate, rotation_vector_rate


@kernel(f"void({VEC}, {VEC})")
def to_increments(y, velocities):
    """Turn velocities at increments ``y`` into dy/dt, in place: w becomes d theta/dt.

    Tracers come after the rods' 6 N numbers; their part must have been cut off both vectors.
    """
    n = y.size // 6
    rotation_vector_rate(y[3 * n :].reshape(3, n), velocities[3 * n :].reshape(3, n))


@inline
def _combine(row, size, y, oldest, f, f0, g):
    """Y_j = mu Y_(j-1) + nu Y_(j-2) + h mu~ (F_(j-1) + g) + h gamma~ F_0, over Y_(j-2)."""
    mu, nu, mu_tilde, gamma_tilde = row[0], row[1], size * row[2], size * row[3]
    for i in range(np.uint64(y.size)):
        oldest[i] = mu * y[i] + nu * oldest[i] + mu_tilde * (f[i] + g[i]) + gamma_tilde * f0[i]


@lru_cache
def stage_loop(blob: int, planar: bool, tracers: bool):
    """Compile ``run(rods, fluid, base, work, omegas, table, begin, end, size, f0, g, Y, f)``.

    Runs the stages begin <= j < end of a three-term recurrence,

        Y_j = mu_j Y_(j-1) + nu_j Y_(j-2) + h (mu~_j (F_(j-1) + g) + gamma~_j F_0),

    with Y_j in row j % 2 of Y (2, n) and the four coefficients in row j of ``table``; then writes
    the velocities (u, w, u at the tracers) at Y_(end-1) into ``f``. Increments are those from the
    state ``base`` = (position, director, tracer), so that Y_0 = 0. fluid: epsilon, viscosity;
    omegas: the strain twist of these evaluations in turn, or one that stands for all.
    """
    # A loop read from the cache is linked at once, and its sums need the threading layer there.
    # Numba sees to that for the sums themselves, not always for what calls them.
    get_num_threads()
    seven = blob == ALGEBRAIC7

    @kernel(f"void({SYSTEM}, {TRIADS}, {MAT}, int64, int64, float64, {VEC}, {VEC}, {MAT}, {VEC})")
    def run(rods, fluid, base, work, omegas, table, begin, end, size, f0, g, Y, f):
        position, director, tracer, internal, loads = work
        epsilon, viscosity = fluid
        n = position.shape[1]
        u = f[: 6 * n].reshape(6, n)
        for j in range(begin, end + 1):
            y = Y[(j - 1) % 2]
            add(base[0], y[: 3 * n].reshape(3, n), position)
            rotate(y[3 * n : 6 * n].reshape(3, n), base[1], director)
            omega = omegas[j - begin if omegas.shape[0] > 1 else 0]
            point_loads(position, director, omega, rods, internal, loads)
            if planar:
                if seven:
                    PLANAR_7(position, position, loads, epsilon, viscosity, u)
                else:
                    PLANAR_9(position, position, loads, epsilon, viscosity, u)
            elif seven:
                SPATIAL_7(position, position, loads, epsilon, viscosity, u)
            else:
                SPATIAL_9(position, position, loads, epsilon, viscosity, u)
            if tracers:
                markers = tracer.shape[1]
                flow = f[6 * n :].reshape(3, markers)
                add(base[2], y[6 * n :].reshape(3, markers), tracer)
                if seven:
                    FLOW_7(tracer, position, loads, epsilon, viscosity, flow)
                else:
                    FLOW_9(tracer, position, loads, epsilon, viscosity, flow)
            if j < end:
                to_increments(y[: 6 * n], f[: 6 * n])
                _combine(table[j], size, y, Y[j % 2], f, f0, g)

    return run
