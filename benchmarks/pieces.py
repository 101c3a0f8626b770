"""The pieces of an evaluation, each alone: in a run they are one compiled loop without a clock."""

from importlib import import_module

import numpy as np


def sum_of(scene, threads, targets=None):
    """Return a function that evaluates the exact sums over a scene's rods once.

    With ``targets`` at so many of the points, evenly spread, instead of all.
    """
    import numba

    from rodsim.flows.velocity import BLOBS, velocity_kernel

    kernel = velocity_kernel(BLOBS[scene.blob], scene.planar)
    position, loads = scene.initial.position, loads_at(scene)
    some = position if targets is None else spread_out(position, targets)
    out = np.zeros((6, some.shape[1]))

    def evaluate():
        numba.set_num_threads(threads)
        kernel(some, position, loads, scene.epsilon, scene.viscosity, 0.0, out)

    return evaluate


def fast_sum_of(scene, threads, accuracy):
    """Return a function that evaluates the fast sums once, with lists that are made before."""
    import numba

    from rodsim.flows.fast.plan import rod_sum

    position, loads = scene.initial.position, loads_at(scene)
    about = scene.epsilon, scene.viscosity, scene.blob
    fast = rod_sum(position, scene.rods.count, accuracy, *about, planar=scene.planar)
    tables, out = fast.prepare(position, loads), np.zeros_like(loads)

    def evaluate():
        numba.set_num_threads(threads)
        out[:] = 0.0
        fast.kernel(tables, position, loads, False, out)

    return evaluate


def gpu_sum_of(scene):
    """Return a function that evaluates the exact sums on a GPU, None where that is not possible."""
    from rodsim import RodsimError, velocity

    position, loads = scene.initial.position.T.copy(), loads_at(scene).T
    args = position, position, loads[:, :3].copy(), loads[:, 3:].copy()

    def evaluate():
        velocity(*args, scene.epsilon, scene.viscosity, blob=scene.blob, device="gpu")

    try:
        evaluate()  # compiles
    except (TypeError, RodsimError):  # a version without GPUs, or a machine
        return None
    return evaluate


def elasticity_of(scene, threads=1):
    """Return a function that turns a scene's triads and computes its point loads once."""
    import numba

    from rodsim.compiled.parts import FORCE
    from rodsim.compiled.rotations import rotate
    from rodsim.forces.elasticity import UNIFORM

    state = scene.initial
    theta, director = np.zeros_like(state.position), np.empty_like(state.director)
    loads, (elastic,) = np.empty((6, scene.rods.points)), scene.parts.of(FORCE)
    add_loads = import_module(elastic.kernel.partition(":")[0])._uniform_loads

    def evaluate():
        numba.set_num_threads(threads)
        rotate(theta, state.director, director)
        omega = elastic.row(0.0).reshape(3, -1)
        loads[:] = 0.0
        add_loads(state.position, director, omega, scene.rods.tables, UNIFORM, loads)

    return evaluate


def loads_at(scene):
    """Return random loads (6, N) on a scene's points."""
    return np.random.default_rng(1).standard_normal((6, scene.rods.points))


def spread_out(points, count):
    """Return so many of the points (3, N), evenly spread."""
    which = np.unique(np.linspace(0, points.shape[1] - 1, count).astype(int))
    return np.ascontiguousarray(points[:, which])
