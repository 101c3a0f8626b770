"""Sums over sources, shared out to threads by their targets.

A sum is compiled as what one thread does, for a run of targets, and called by its address:

    run(begin, end, targets, sources, loads, epsilon, viscosity, wall, out)

So each is compiled once, without threads, and these are here for all of them. However many threads
there are, and on one without any, it is the same machine code: the bits do not depend on them.
"""

from functools import partial
from importlib import import_module

from numba import prange

from rodsim.compiled.flags import MAT, call_run, kernel, thread_count, threaded_kernel
from rodsim.compiled.kernels import address_of, pair_sum

ARRAYS = f"{MAT}, {MAT}, {MAT}, float64, float64, float64, {MAT}"


@threaded_kernel(f"void(int64, int64, {ARRAYS})")
def _share_out(threads, run, targets, sources, loads, epsilon, viscosity, wall, out):
    """Let each thread add to the velocities at its share of the targets."""
    count = targets.shape[1]
    for k in prange(threads):
        begin, end = k * count // threads, (k + 1) * count // threads
        call_run(run, begin, end, targets, sources, loads, epsilon, viscosity, wall, out)


@kernel(f"void(int64, {ARRAYS})")
def add_velocities(run, targets, sources, loads, epsilon, viscosity, wall, out):
    """Add to ``out`` (6, T) or (3, T) the sum whose runs are at the address ``run``.

    targets (3, T), sources (3, N), loads (6, N). wall : its height, of sums at a wall.
    """
    threads = min(thread_count(), targets.shape[1])
    if threads > 1:
        _share_out(threads, run, targets, sources, loads, epsilon, viscosity, wall, out)
    else:  # launching costs more than a sum over few points
        call_run(run, 0, targets.shape[1], targets, sources, loads, epsilon, viscosity, wall, out)


@pair_sum
def share_out(run, targets, sources, loads, epsilon, viscosity, wall, out):
    """Do the same for those who call a sum by its address."""
    add_velocities(run, targets, sources, loads, epsilon, viscosity, wall, out)


def velocity_kernel(blob, planar=False, angular=True, at_wall=False):
    """Return ``kernel(targets, sources, loads, epsilon, viscosity, wall, out)`` for Python.

    Of a planar scene, for targets that do not need w, or at a wall, whose height is else not used.
    """
    which = "flow" if not angular else "planar" if planar else "spatial"
    return partial(add_velocities, address_of(f"{_home(at_wall)}:{which}_{blob}"))


def pressure_kernel(blob, at_wall=False):
    """Return ``kernel(targets, sources, loads, epsilon, wall, out)`` of the pressure (T,)."""
    return import_module(_home(at_wall)).pressure_kernel(blob)


def _home(at_wall):
    return f"rodsim.flows.{'wall' if at_wall else 'free'}"
