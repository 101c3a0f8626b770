"""Evaluations in a compiled loop: the stages of a step without a Python call in between."""

from functools import lru_cache

import numpy as np
from numba import get_num_threads

from rodsim.compiled.flags import MAT, SYSTEM, TRIADS, VEC, inline, kernel
from rodsim.compiled.rotations import displace, rotation_vector_rate
from rodsim.flows.blobs import ALGEBRAIC7
from rodsim.flows.free import FLOW_7, FLOW_9, PLANAR_7, PLANAR_9, SPATIAL_7, SPATIAL_9
from rodsim.forces.elasticity import point_loads


@kernel(f"void({VEC}, {VEC})")
def to_increments(y, velocities):
    """Turn velocities at increments ``y`` into dy/dt, in place: w becomes d theta/dt.

    Tracers come after the rods' 6 N numbers; their part must have been cut off both vectors.
    """
    n = y.size // 6
    rotation_vector_rate(y[3 * n :].reshape(3, n), velocities[3 * n :].reshape(3, n))


@inline
def _first(mu_tilde, f0, g, Y):
    """Y_1 = h mu~_1 (F_0 + g), after Y_0 = 0."""
    for i in range(np.uint64(f0.size)):
        Y[0, i] = 0.0
        Y[1, i] = mu_tilde * (f0[i] + g[i])


@inline
def _combine(row, size, y, oldest, f, f0, g):
    """Write Y_j, see below, over Y_(j-2)."""
    mu, nu, mu_tilde, gamma_tilde = row[0], row[1], size * row[2], size * row[3]
    for i in range(np.uint64(y.size)):
        rates = mu_tilde * (f[i] + g[i]) + gamma_tilde * (f0[i] + g[i])
        oldest[i] = mu * y[i] + nu * oldest[i] + rates


@lru_cache
def stage_loop(blob: int, planar: bool, tracers: bool):
    """Compile ``run(rods, fluid, base, work, omegas, table, begin, end, size, f0, g, Y, f)``.

    Runs the stages begin <= j < end of a three-term recurrence, with g added to all rates F,

        Y_0 = 0,    Y_1 = h mu~_1 (F_0 + g),
        Y_j = mu_j Y_(j-1) + nu_j Y_(j-2) + h (mu~_j (F_(j-1) + g) + gamma~_j (F_0 + g)),

    with Y_j in row j % 2 of Y (2, n) and the four coefficients in row j of ``table``; then writes
    the velocities (u, w, u at the tracers) at Y_(end-1) into ``f``. With begin = 2 it makes Y_0
    and Y_1 first; with begin = end = 1 it evaluates at row 0 as it is. Increments are those from
    the state ``base`` = (position, director, tracer). fluid: epsilon, viscosity; omegas: the
    strain twist of these evaluations in turn, or one that stands for all.
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
        if begin == 2:
            _first(size * table[1, 2], f0, g, Y)
        for j in range(begin, end + 1):
            y = Y[(j - 1) % 2]
            displace(base, y, (position, director, tracer))
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
                if seven:
                    FLOW_7(tracer, position, loads, epsilon, viscosity, flow)
                else:
                    FLOW_9(tracer, position, loads, epsilon, viscosity, flow)
            if j < end:
                to_increments(y[: 6 * n], f[: 6 * n])
                _combine(table[j], size, y, Y[j % 2], f, f0, g)

    return run
