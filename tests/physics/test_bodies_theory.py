"""Rigid bodies against exact results: drag, torque, two spheres, a wall, Faxen's laws."""

import bodies_theory as theory
import numpy as np
import pytest
from acting import changed
from held import PLAIN, SWIMMER
from scenes import system_from
from scipy.spatial.transform import Rotation

from rodsim.blocks.table import Block
from rodsim.flows.blobs import BLOBS
from rodsim.scene.state import State

MU, A = 1.3, 0.7
PASSIVE = changed(PLAIN, {"rods.tail.strain_twist": [0, 0, 0],
                          "rods.tail.shape.origin": [0.0, 0.0, 9.0]})  # fmt: skip
SPHERE = {"kind": "sphere", "radius": A, "points": 100}


def of_bodies(bodies, **changes):
    """Return the system of bodies beside a rod at rest, which only goes along."""
    return system_from(changed(PASSIVE, {"bodies": bodies, **changes}))[1]


def motions(system):
    """Return the velocity and the angular velocity of each body, (B, 6)."""
    out = system.velocities(0.0, system.scene.initial, system.zeros(), system.zeros())
    return out[: 6 * system.scene.nodes].reshape(6, -1)[:, system.scene.rods.points :].T


@pytest.mark.parametrize("blob", BLOBS)
@pytest.mark.parametrize(
    ("shape", "tolerance"),
    [
        (SPHERE, 1e-3),
        ({"kind": "spheroid", "length": 4 * A, "radius": A, "points": 100}, 6e-3),
        ({"kind": "spheroid", "length": 8 * A, "radius": A, "points": 100}, 1.2e-2),
    ],
)
def test_drag_and_torque_of_spheres_and_spheroids(shape, tolerance, blob):
    """bodies.md 1.2 of the design, 100 points: 0.1 % of a sphere, 0.5 % at 2:1, 0.9 % at 4:1
    (algebraic9: 1.1 %)."""
    system = of_bodies({"body": {"shape": shape}}, **{"fluid.blob": blob})
    body = system.scene.bodies[0]
    a = A if shape["kind"] == "sphere" else 0.5 * shape["length"]
    found = theory.measured_factors(body.resistance, a, MU)
    assert found == pytest.approx(theory.resistance_factors(body.shape), rel=tolerance)
    # Point inversion forbids that it turns as it is pulled.
    assert abs(body.resistance[:3, 3:]).max() < 1e-12 * body.resistance[0, 0]


def test_more_points_make_a_spherocylinder_no_different():
    shape = {"kind": "spherocylinder", "length": 4 * A, "radius": 0.8 * A}
    drags = [np.diag(of_bodies({"body": {"shape": {**shape, "points": n}}})
                     .scene.bodies[0].resistance) for n in (60, 180)]  # fmt: skip
    assert drags[0] == pytest.approx(drags[1], rel=8e-3)  # 60 points: 0.8 % in torque


@pytest.mark.compiled
@pytest.mark.parametrize("distance", theory.STIMSON_JEFFERY)
def test_two_spheres_along_their_line(distance):
    """0.02 % of Stimson & Jeffery's series at 100 points; its values are those of the table."""
    force = 2.1
    bodies = {
        name: {"shape": {**SPHERE, "origin": [0, 0, z * A]}, "force": [0, 0, force]}
        for name, z in (("one", 0.0), ("two", -distance))
    }
    found = motions(of_bodies(bodies))[:, 2] * 6 * np.pi * MU * A / force
    exact = theory.stimson_jeffery(distance)
    assert exact == pytest.approx(theory.STIMSON_JEFFERY[distance], abs=6e-5)
    assert found == pytest.approx([exact, exact], rel=5e-4)


@pytest.mark.compiled
@pytest.mark.parametrize(("height", "tolerance"), [(1.5, 2e-2), (2.0, 5e-3), (3.0, 2e-3)])
def test_a_sphere_near_a_wall(height, tolerance):
    """Brenner's series away from it, Faxen's along it, which is 1 % off itself at 1.5 a.

    100 points do not resolve the gap: 1.6 % too little drag at 1.5 a, 0.3 % at 2 a.
    """
    for axis, exact in ((2, theory.brenner(height)), (0, theory.along_wall(height))):
        force = np.zeros(3)
        force[axis] = 1.7
        body = {"shape": {**SPHERE, "origin": [0, 0, height * A]}, "force": list(force)}
        U = motions(of_bodies({"body": body}, **{"fluid.wall": {"z": 0.0}}))[0, axis]
        found = 1.7 / (6 * np.pi * MU * A * U)
        assert found == pytest.approx(exact, rel=tolerance)


@pytest.mark.parametrize(("distance", "tolerance"), [(1.25, 0.008), (1.5, 0.008), (2.5, 0.002)])
def test_a_free_sphere_beside_a_point_force_follows_faxen(distance, tolerance):
    """Above a pole; U = G^T v of its block. From 1.5 a on in any direction."""
    surface = of_bodies({"body": {"shape": SPHERE}}).scene.bodies[0].surface
    G = Block("body", 0, (), surface, free=True).factors("algebraic7", 0.31, MU).G
    along, across, spin = np.array(theory.faxen(distance)) / np.array([A, A, A * A])
    ways = [[0, 0, 1.0]] if distance < 1.5 else [[0, 0, 1.0], [0.6, 0, 0.8], [0.28, 0.96, 0]]
    for way in np.array(ways):
        normal = np.cross(way, [0.3, 1.0, 0.2])
        normal /= np.linalg.norm(normal)
        pulled, pushed = (
            G.T @ theory.stokeslet(surface.points, distance * A * way, f, MU).T.ravel()
            * 8 * np.pi * MU for f in (way, normal)
        )  # fmt: skip
        assert pulled[:3] @ way == pytest.approx(along, rel=tolerance)
        assert pushed[:3] @ normal == pytest.approx(across, rel=tolerance)
        about = np.cross(normal, way)
        assert pushed[3:] @ about == pytest.approx(-spin, rel=2 * tolerance)


def test_a_towed_body_is_pulled_with_the_drag_of_a_free_one():
    """What holds it exerts R (U, Omega); a free one under that load moves as the towed one does."""
    motion = {"velocity": [0.3, -0.2, 0.5], "spin": [0.4, 0.1, -0.6]}
    shape = {"kind": "spheroid", "length": 3.1 * A, "radius": A, "points": 40,
             "rotate": {"axis": [0.2, 1.3, 0.4], "degrees": 70}}  # fmt: skip
    system = of_bodies({"body": {"shape": shape, "motion": motion}})
    _, seen = system.observe(system.scene.initial)
    load = np.concatenate([seen["anchor_force"][0], seen["anchor_torque"][0]])
    body = system.scene.bodies[0]
    turn = np.kron(np.eye(2), body.turn)
    given = np.array([*motion["velocity"], *motion["spin"]])
    assert load == pytest.approx(turn @ body.resistance @ turn.T @ given, rel=1e-10)
    free = of_bodies({"body": {"shape": shape, "force": list(load[:3]), "torque": list(load[3:])}})
    assert motions(free)[0] == pytest.approx(given, rel=1e-10)


def test_a_scene_of_free_bodies_does_not_know_where_it_is():
    _, system = system_from(SWIMMER)
    start, turn = system.scene.initial, Rotation.from_rotvec([0.7, -1.9, 0.4]).as_matrix()
    position = turn @ start.position + np.array([[3.0], [-2.0], [7.0]])
    director = np.einsum("ab,ibk->iak", turn, start.director)
    moved = State(0.0, position, director, start.tracer, start.work)
    here, there = (
        system.velocities(0.0, s, system.zeros(), system.zeros())[: 6 * system.scene.nodes]
        .reshape(2, 3, -1).copy() for s in (start, moved)
    )  # fmt: skip
    expected = np.einsum("ab,cbk->cak", turn, here)
    assert there == pytest.approx(expected, abs=1e-12 * abs(here).max())
