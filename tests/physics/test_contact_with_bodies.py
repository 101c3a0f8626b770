"""Contact with bodies: forces against energies and formulas, net force and torque, balance."""

import numpy as np
import pytest
from acting import changed
from scenes import end_of, system_from
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from rodsim.case import case_from_mapping
from rodsim.compiled.parts import PartList
from rodsim.forces.bodies import surfaces_of
from rodsim.scene.evaluation import Evaluation

MODULI = {"bending": [0.36, 0.42], "twisting": 0.29, "shear": 21.0, "stretch": 17.0}
ROD = {"shape": {"kind": "straight", "points": 21, "length": 2.2, "origin": [0.1, -0.2, 0.95]},
       "moduli": MODULI}  # fmt: skip
CROWD = {  # every shape touches another one, rods touch two of them, one body the wall
    "fluid": {"viscosity": 1.3, "epsilon": 0.31, "wall": {"z": -1.09}},
    "rods": {
        "tail": {**ROD, "start": {"hold": "clamped", "to": "ball"}},
        "other": {**ROD, "shape": {**ROD["shape"], "origin": [0.15, -1.13, -0.75],
                                   "rotate": {"axis": [0, 1, 0], "degrees": 5}}},
    },
    "bodies": {
        "ball": {"shape": {"kind": "sphere", "radius": 0.8, "points": 20,
                           "origin": [0.1, -0.2, 0.15]}},
        "egg": {"shape": {"kind": "spheroid", "length": 2.1, "radius": 0.7, "points": 22,
                          "rotate": {"axis": [0.2, 1.3, 0.4], "degrees": 70},
                          "origin": [1.9, 0.3, -0.15]}},
        "lens": {"shape": {"kind": "spheroid", "length": 0.6, "radius": 0.9, "points": 22,
                           "origin": [0.2, 0.83, 1.19]}},
        "stick": {"shape": {"kind": "spherocylinder", "length": 2.0, "radius": 0.4, "points": 22,
                            "rotate": {"axis": [1, 0, 0], "degrees": 80},
                            "origin": [-1.2, 0.3, 0.1]}},
    },
    "contact": {"diameter": 0.39, "strength": 23.0},
    "time": {"end": 0.1},
}  # fmt: skip
D, A = 0.39, 23.0 * 0.42 / 0.39**3  # of the larger bending modulus
CONTACT = ("contact", "contact_wall", "contact_bodies", "contact_bodies_wall")
FAR = {"tail": {**ROD, "shape": {**ROD["shape"], "points": 3, "length": 0.22,
                                 "origin": [9.0, 9.0, 9.0]}}}  # fmt: skip


def loads_of(scene, state, names=CONTACT):
    """Return what contact adds to the loads (6, N) of all nodes."""
    parts = PartList(part for part in scene.parts if part.name in names)
    loads = np.zeros((6, scene.nodes))
    Evaluation(scene, parts).add(state, loads, np.zeros_like(loads), np.zeros((3, 0)))
    return loads


def energy(scene, state):
    (part,) = (part for part in scene.parts if part.name == "contact")
    return part.observe(state, part.row, scene)["contact_energy"]


def moved(state, way):
    """Return a state whose nodes have moved and turned by ``way`` (6, N)."""
    director = state.director.copy()
    for k, turn in enumerate(way[3:].T):
        director[:, :, k] = director[:, :, k] @ Rotation.from_rotvec(turn).as_matrix().T
    return type(state)(0.0, state.position + way[:3], director, state.tracer, state.work)


@pytest.fixture(scope="module")
def crowd():
    return system_from(CROWD)[1].scene


def test_forces_and_torques_are_the_gradient_of_the_energy(crowd):
    """Sixth-order differences of step 1e-5; a ball or point that crosses d/2 leaves 1e-10."""
    state, rng, h = crowd.initial, np.random.default_rng(5), 1e-5
    loads = loads_of(crowd, state)
    assert abs(loads[:3, -4:]).max(axis=0).min() > 3.0  # all four bodies
    assert (abs(loads[:3, :21]).max(axis=0) > 0.0).sum() > 2
    for _ in range(5):
        way = rng.normal(size=loads.shape)
        ends = [
            weight * (energy(crowd, moved(state, side * n * h * way)).sum() * side)
            for n, weight in ((1, 45), (2, -9), (3, 1))
            for side in (1, -1)
        ]
        size = abs(loads * way).sum()
        assert sum(ends) / (60.0 * h) == pytest.approx(-(loads * way).sum(), abs=1e-10 * size)


def test_there_is_no_net_force_and_no_net_torque_but_of_the_wall(crowd):
    state = crowd.initial
    loads = loads_of(crowd, state, ("contact_bodies",))
    torque = np.cross(state.position, loads[:3], axis=0) + loads[3:]
    size = abs(loads).max()
    assert loads[:3].sum(axis=1) == pytest.approx([0, 0, 0], abs=1e-14 * size)
    assert torque.sum(axis=1) == pytest.approx([0, 0, 0], abs=2e-14 * size)
    wall = loads_of(crowd, state, ("contact_bodies_wall",))
    assert wall[:2].tolist() == np.zeros_like(wall[:2]).tolist()
    assert wall[2].sum() > 1.0


def test_compiled_distances_are_those_of_the_checks(crowd):
    """Of what is nearest, after motions of all that let others come nearest."""
    weights, excluded = np.full(crowd.rods.points, 0.7), crowd.parts.apart.excluded
    surfaces = surfaces_of(case_from_mapping(CROWD), crowd, D, weights, A, excluded)
    rng, seen = np.random.default_rng(2), set()
    for _ in range(12):
        state = moved(crowd.initial, 0.05 * rng.normal(size=(6, crowd.nodes)))
        s, who, _ = surfaces.meet(state)[1]
        found = surfaces.closest(state)
        assert s == pytest.approx(found[0], abs=1e-13)
        seen.add(int(who))
    assert len(seen) > 2


def test_a_rod_does_not_feel_the_body_that_holds_it_near_its_end(crowd):
    """Within the exclusion, 5 segments of 0.11; the lens that leans over it pushes it."""
    alone = changed(CROWD, {"bodies": {"ball": CROWD["bodies"]["ball"]}, "rods.other": None})
    assert not loads_of(system_from(alone)[1].scene, crowd.initial)[:, :21].any()
    loose = changed(alone, {"rods.tail.start": None, "rods.tail.shape.origin": [0.1, -0.2, 1.09]})
    scene = system_from(loose)[1].scene
    assert loads_of(scene, scene.initial)[2, 0] > 1.0


def push(s, weight):
    """The force of the formula: of a wall on a point that counts as that length of rod."""
    return 12.8 * A * weight * (s / D) * max(1.0 - (2.0 * s / D) ** 2, 0.0) ** 2.5


def scene_of(bodies, **more):
    case = {**CROWD, "fluid": {"viscosity": 1.3, "epsilon": 0.31}, "rods": FAR, "bodies": bodies}
    return system_from({**case, **more})[1].scene


BALL = {"shape": {"kind": "sphere", "radius": 0.8, "points": 20}}


@pytest.mark.parametrize(
    "shape",
    [
        {"kind": "sphere", "radius": 0.5},
        {"kind": "spherocylinder", "radius": 0.5, "length": 1.0},
        {"kind": "spheroid", "radius": 0.5, "length": 1.0},
        {"kind": "spheroid", "radius": 0.5, "length": 1.002},
        {"kind": "spheroid", "radius": 0.501, "length": 1.0},
    ],
)
def test_a_sphere_counts_as_its_radius_however_it_is_written(shape):
    """Two of radii R, r: (R + r)/2 of the formula; 0.2 % of shape moves s by 1e-3 at most."""
    s = 0.14
    other = {"shape": {**shape, "points": 20, "origin": [1.3 + s, 0, 0]}}
    scene = scene_of({"ball": BALL, "other": other})
    loads = loads_of(scene, scene.initial)[:, -2:]
    assert loads[0] == pytest.approx(np.array([-1, 1]) * push(s, 0.65), rel=3e-2)
    if shape["radius"] == 0.5 and shape.get("length", 1.0) == 1.0:
        assert loads[0] == pytest.approx(np.array([-1, 1]) * push(s, 0.65), rel=1e-10)
        assert loads[3:] == pytest.approx(np.zeros((3, 2)), abs=1e-12)


def test_a_point_of_a_rod_is_pushed_as_by_a_wall():
    """Along the normal of a long spheroid, the foot at an angle u of its ellipse."""
    a, b, u, s = 1.3, 0.5, 0.7, 0.13
    foot, normal = (
        np.array([b * np.sin(u), a * np.cos(u)]),
        np.array([np.sin(u) / b, np.cos(u) / a]),
    )
    x, z = foot + s * normal / np.linalg.norm(normal)
    rod = {"tail": {**ROD, "shape": {"kind": "straight", "points": 3, "spacing": 0.14,
                                     "origin": [x, 0, z], "rotate": {"axis": [0, 1, 0],
                                                                     "degrees": 60}}}}  # fmt: skip
    egg = {"shape": {"kind": "spheroid", "length": 2 * a, "radius": b, "points": 20}}
    scene = scene_of({"egg": egg}, rods=rod)
    force = loads_of(scene, scene.initial)[:3, 0]
    expected = push(s, 0.07) * normal / np.linalg.norm(normal)
    assert force == pytest.approx([expected[0], 0.0, expected[1]], rel=1e-9, abs=1e-9)


def test_a_stick_that_lies_on_a_wall_counts_as_its_middle_line_and_its_radius():
    lying = {"axis": [0, 1, 0], "degrees": 90}
    stick = {"shape": {"kind": "spherocylinder", "length": 2.4, "radius": 0.5, "points": 20,
                       "rotate": lying}}  # fmt: skip
    scene = scene_of({"stick": stick},
                     fluid={"viscosity": 1.3, "epsilon": 0.31, "wall": {"z": -0.63}})  # fmt: skip
    loads = loads_of(scene, scene.initial)[:, -1]
    assert loads[2] == pytest.approx(push(0.13, 1.4 + 0.5), rel=1e-10)
    assert loads[3:] == pytest.approx([0, 0, 0], abs=1e-10)


@pytest.mark.compiled
def test_what_is_pressed_comes_to_rest_where_forces_balance():
    """A ball drawn onto a rod that is held, one pressed on the wall, two drawn to each other."""
    F, held = 1.7, {"hold": "hinged"}
    bar = {**ROD, "moduli": {**MODULI, "bending": 3.1}, "start": held, "end": held,
           "shape": {"kind": "straight", "points": 9, "length": 1.12, "origin": [-0.56, 0, 0.9],
                     "rotate": {"axis": [0, 1, 0], "degrees": 90}}}  # fmt: skip
    places = {"on_rod": [0, 0, 1.46], "on_wall": [4, 0, 0.56], "left": [9, 0, 3],
              "right": [9.95, 0, 3]}  # fmt: skip
    bodies = {
        name: {"shape": {"kind": "sphere", "radius": 0.4, "points": 20, "origin": place}}
        for name, place in places.items()
    }
    bodies["on_wall"]["force"] = [0, 0, -F]

    def end_at(name):
        return {"body": name, "at": [0, 0, 0]}

    end, system = end_of({
        "fluid": {"viscosity": 0.13, "epsilon": 0.23, "wall": {"z": 0.0}},
        "rods": {"bar": bar}, "bodies": bodies, "contact": {"diameter": D, "strength": 23.0},
        "tethers": {
            "down": {"from": end_at("on_rod"), "to": [0, 0, 0.3], "stiffness": 1.5},
            "pair": {"from": end_at("left"), "to": end_at("right"), "stiffness": 2.3},
        },
        "time": {"end": 0.6, "tolerance": 1e-3},
    })  # fmt: skip
    loads, centres = loads_of(system.scene, end)[:, -4:], end.position[:, -4:]
    apart = centres[0, 3] - centres[0, 2]
    drawn = [1.5 * (centres[2, 0] - 0.3), F, -2.3 * apart, 2.3 * apart]
    found = [loads[2, 0], loads[2, 1], *loads[0, 2:]]
    assert found == pytest.approx(drawn, rel=1e-2)
    for s, force in ((centres[2, 1] - 0.4, F), (apart - 0.8, 2.3 * apart)):
        rest = brentq(lambda x, f=force: 3.1 / 0.42 * push(x, 0.4) - f, 0.3 * D, 0.5 * D)
        assert s == pytest.approx(rest, abs=2e-4)
    assert end.position[2, 4] < 0.899  # the bar is bent
