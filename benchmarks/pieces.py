"""The pieces of an evaluation, each alone: in a run they are one compiled loop without a clock."""

import numpy as np


def sum_of(scene, threads):
    """Return a function that evaluates the sums over a scene's rods once."""
    import numba

    from rodsim.flows.velocity import BLOBS, velocity_kernel

    kernel = velocity_kernel(BLOBS[scene.blob], scene.planar)
    position = scene.initial.position
    loads = np.random.default_rng(1).standard_normal((6, scene.rods.points))
    out = np.zeros_like(loads)

    def evaluate():
        numba.set_num_threads(threads)
        kernel(position, position, loads, scene.epsilon, scene.viscosity, out)

    return evaluate


def elasticity_of(scene):
    """Return a function that turns a scene's triads and computes its point loads once."""
    from rodsim.compiled.parts import FORCE
    from rodsim.compiled.rotations import rotate
    from rodsim.forces.elasticity import point_loads

    state = scene.initial
    theta, director = np.zeros_like(state.position), np.empty_like(state.director)
    loads, (elastic,) = np.empty((6, scene.rods.points)), scene.parts.of(FORCE)

    def evaluate():
        rotate(theta, state.director, director)
        omega = elastic.row(0.0).reshape(3, -1)
        loads[:] = 0.0
        point_loads(state.position, director, omega, scene.rods.tables, loads)

    return evaluate
