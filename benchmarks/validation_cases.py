"""The problems of ``validation.py``: each returns what rodsim gives for one of them."""

from types import SimpleNamespace

import numpy as np
from bodies_theory import measured_factors, resistance_factors, stokeslet
from extremes import changed

MU = 1.0
BESIDE = {  # a rod at rest that only goes along: a case needs one
    "fluid": {"viscosity": MU, "epsilon": 0.1},
    "rods": {"rod": {"shape": {"kind": "straight", "points": 3, "spacing": 0.1,
                               "origin": [0, 0, 40]},
                     "moduli": {"bending": 2.0, "twisting": 2.0, "shear": 3.0, "stretch": 3.0}}},
    "time": {"end": 0.5},
}  # fmt: skip


def system_of(data):
    """Return the system of a case that is plain data."""
    from rodsim.case import case_from_mapping
    from rodsim.scene.build import build_scene
    from rodsim.scene.system import RodSystem

    return RodSystem(build_scene(case_from_mapping(data)))


def motions(data):
    """Return velocity and angular velocity (B, 6) of the bodies of a case at t = 0."""
    system = system_of(data)
    out = system.velocities(0.0, system.scene.initial, system.zeros(), system.zeros())
    return out[: 6 * system.scene.nodes].reshape(6, -1)[:, system.scene.rods.points :].T


def drag_factors(shape):
    """Return the four factors of a shape, ours and exact."""
    body = system_of(changed(BESIDE, {"bodies": {"body": {"shape": shape}}})).scene.bodies[0]
    a = shape["radius"] if shape["kind"] == "sphere" else 0.5 * shape["length"]
    return measured_factors(body.resistance, a, MU), resistance_factors(body.shape)


def two_spheres(distance, points):
    """Return U 6 pi mu a/F of two spheres along their line."""
    sphere = {"kind": "sphere", "radius": 1.0, "points": points}
    bodies = {name: {"shape": {**sphere, "origin": [0, 0, z]}, "force": [0, 0, 2.0]}
              for name, z in (("one", 0.0), ("two", -distance))}  # fmt: skip
    return motions(changed(BESIDE, {"bodies": bodies}))[:, 2].mean() * 3.0 * np.pi * MU


def near_wall(height, axis, points):
    """Return F/(6 pi mu a U) of a sphere whose centre is so many radii above a wall."""
    shape = {"kind": "sphere", "radius": 1.0, "points": points, "origin": [0, 0, height]}
    body = {"shape": shape, "force": [2.0 * (i == axis) for i in range(3)]}
    data = changed(BESIDE, {"bodies": {"body": body}, "fluid.wall": {"z": 0.0}})
    return 2.0 / (6.0 * np.pi * MU * motions(data)[0, axis])


def beside_a_force(distance, points, way):
    """Return U 8 pi mu/f along and across, Omega 8 pi mu/f, of a free sphere of radius 1."""
    from rodsim.blocks.table import Block

    shape = {"kind": "sphere", "radius": 1.0, "points": points}
    body = system_of(changed(BESIDE, {"bodies": {"body": {"shape": shape}}})).scene.bodies[0]
    G = Block("body", 0, (), body.surface, free=True).factors("algebraic7", 0.1, MU).G
    across = np.cross(way, [0.3, 1.0, 0.2])
    across /= np.linalg.norm(across)
    pulled, pushed = (
        8 * np.pi * MU * G.T @ stokeslet(body.surface.points, distance * way, f, MU).T.ravel()
        for f in (way, across)
    )
    return pulled[:3] @ way, pushed[:3] @ across, pushed[3:] @ np.cross(way, across)


def rotating_helix(pitch, axial, a, spacing_over_epsilon=1.0):
    """Return F/(mu Omega R^2), T/(mu Omega R^3), D/(mu U R) of a rigid helix of radius 1."""
    from rodsim.blocks.mobility import mobility, rigid_motion
    from rodsim.scene.shapes import helix

    epsilon = a * np.exp(0.5)
    length = axial * np.hypot(1.0, 2.0 * np.pi / pitch)
    segments = round(length / (epsilon * spacing_over_epsilon))
    shape = SimpleNamespace(radius=1.0, pitch=pitch, points=segments + 1, length=length,
                            ds=length / segments, taper=None)  # fmt: skip
    X, _ = helix(shape)
    none = np.zeros((3, 0))
    A = mobility(none, X, "algebraic7", (epsilon, epsilon), MU)
    K = rigid_motion(none, X)[:, [2, 5]]
    resistance = K.T @ np.linalg.solve(A, K)
    return abs(resistance[0, 1]), resistance[1, 1], resistance[0, 0]


def rigid_swimmer(points, torques=True):
    """Return U, spin and motor torque of a swimmer whose tail, 7 long at pitch 2, is rigid."""
    from rodsim.blocks.mobility import mobility, rigid_motion

    tail = {"kind": "helix", "radius": 0.2, "pitch": 2.0, "points": points, "length": 7.0,
            "taper": 1.0 / np.pi, "origin": [0, 0, 1.1]}  # fmt: skip
    head = {"shape": {"kind": "sphere", "radius": 1.0, "points": 100}}
    scene = system_of(changed(BESIDE, {"bodies": {"head": head}, "rods.rod.shape": tail,
                                       "fluid.epsilon": 0.05 * np.exp(0.5)})).scene  # fmt: skip
    surface, X = scene.bodies[0].surface, scene.initial.position[:, :points]
    n = surface.points.shape[1]
    A = mobility(surface.points, X, "algebraic7", (surface.epsilon, scene.epsilon), MU)
    K = rigid_motion(surface.points, X)
    keep = np.append(np.full(3 * n, True), np.tile([True] * 3 + [torques] * 3, points))
    spin = K[:, 5].copy()
    spin[: 3 * n] = 0.0
    A, K, spin = A[np.ix_(keep, keep)], K[keep], spin[keep]
    loads = np.linalg.solve(A, np.column_stack([K, spin]))
    motion = np.linalg.solve(K.T @ loads[:, :6], -K.T @ loads[:, 6])
    return motion[2], motion[5], spin @ (loads[:, :6] @ motion + loads[:, 6])
