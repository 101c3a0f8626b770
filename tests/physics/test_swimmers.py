"""A helical swimmer whose tail does not bend, as one dense system: published numbers of it."""

import block_twin
import numpy as np
import pytest
from scenes import system_from

A, PITCH, LENGTH, EPSILON, GAP = 0.2, 2.0, 7.0, 0.082436, 0.1


def swimmer(points, pitch=PITCH):
    """Return a sphere of radius 1 with a helical tail on a motor, mu = 1, as it is built."""
    tail = {"kind": "helix", "radius": A, "pitch": pitch, "points": points, "length": LENGTH,
            "taper": PITCH / (2 * np.pi), "origin": [0, 0, np.sign(pitch) * (1 + GAP)]}  # fmt: skip
    return {
        "fluid": {"viscosity": 1.0, "epsilon": EPSILON},
        "bodies": {"head": {"shape": {"kind": "sphere", "radius": 1.0, "points": 100}}},
        "rods": {"tail": {"shape": tail, "moduli": {"bending": 5.0, "twisting": 5.0,
                                                    "shear": 50.0, "stretch": 50.0},
                          "start": {"hold": "clamped", "to": "head", "gap": True,
                                    "motor": {"rate": 1.0, "axis": [0, 0, 1]}}}},
        "time": {"end": 0.5},
    }  # fmt: skip


def rigid_motion(system, torques=True):
    """Return U, Omega of the head and the motor's torque if the tail turns rigidly at rate 1.

    All points of the tail bear forces and torques, those of the head forces: one system for all.
    """
    scene, n = system.scene, system.scene.rods.points
    head = scene.bodies[0]
    surface, tail = head.surface.points.T, scene.initial.position[:, :n].T
    X = np.concatenate([surface, tail])
    sizes = np.append(np.full(len(surface), head.surface.epsilon), np.full(n, scene.epsilon))
    pair = np.sqrt(0.5 * (sizes[:, None] ** 2 + sizes**2))
    M = block_twin.mobility(X, X, pair, scene.viscosity, scene.blob)
    keep = np.tile([True] * 3 + [False] * 3, len(X))
    keep[6 * len(surface) :] |= torques
    K = np.concatenate([block_twin._rigid(x) for x in X])
    spin = K[:, 5].copy()
    spin[: 6 * len(surface)] = 0.0
    M, K, spin = M[np.ix_(keep, keep)], K[keep], spin[keep]
    loads = np.linalg.solve(M, np.column_stack([K, spin]))
    resistance, driven = K.T @ loads[:, :6], K.T @ loads[:, 6]
    motion = np.linalg.solve(resistance, -driven)
    return motion, spin @ (loads[:, :6] @ motion + loads[:, 6])


@pytest.mark.parametrize(
    ("points", "torques", "expected"),
    [
        (86, True, (0.013815, -0.050363, 1.32912)),
        (128, True, (0.013889, -0.050826, 1.34145)),
        (86, False, (0.013662, -0.041371, 1.08481)),
    ],
)
def test_speed_spin_and_torque_of_a_rigid_swimmer(points, torques, expected):
    """Numbers of a separate program; an epsilon is 1 or 1.5 spacings."""
    _, system = system_from(swimmer(points))
    motion, torque = rigid_motion(system, torques)
    assert (motion[2], motion[5], torque) == pytest.approx(expected, rel=1e-3)
    _, mirrored = system_from(swimmer(points, -PITCH))
    other, same = rigid_motion(mirrored, torques)
    assert other[2] == pytest.approx(-motion[2], rel=1e-3)  # the mirror image, turned the same way
    assert same == pytest.approx(torque, rel=1e-3)
