"""What loads, tethers and background flows add, against obvious twins in NumPy."""

import numpy as np
import pytest
from acting import ROD, changed, of_part
from scenes import system_from

from rodsim.case.expressions import Expression
from rodsim.scene.shapes import rotation_matrix
from rodsim.scene.state import State

RING = {
    "shape": {"kind": "ring", "radius": 0.6, "points": 9, "origin": [0.3, 1.4, 0.2]},
    "moduli": {"bending": 0.5, "twisting": 0.3, "shear": 12.0, "stretch": 13.0},
}
TWO = changed(ROD, {"rods.ring": RING})


def shaken(system, time=0.37):
    """A state that is no special one: points displaced, triads turned."""
    random = np.random.default_rng(11)
    start = system.scene.initial
    director = start.director.copy()
    for k in range(director.shape[2]):
        turn = rotation_matrix(random.normal(size=3), random.uniform(-2.0, 2.0))
        director[:, :, k] = director[:, :, k] @ turn.T
    position = start.position + random.normal(0.0, 0.3, start.position.shape)
    return State(time, position, director, np.zeros((3, 0)), start.work)


def test_a_force_per_length_is_half_at_open_ends_and_adds_up_to_f_l():
    force = [0.11, -0.07, -0.23]
    _, system = system_from(changed(TWO, {
        "rods.rod.loads": {"weight": {"along": "all", "force": force}},
        "rods.ring.loads": {"weight": {"along": "all", "force": force, "torque": [0, 0.3, 0]}},
    }))  # fmt: skip
    loads, _ = of_part(system, "loads", shaken(system))
    ds = 0.13 * np.array([0.5, *10 * [1.0], 0.5])
    assert loads[:3, :12] == pytest.approx(np.outer(force, ds), rel=1e-15)
    assert not loads[3:, :12].any()
    length = system.scene.rods.lengths
    for r, nodes in enumerate((np.s_[:12], np.s_[12:])):
        total = loads[:3, nodes].sum(axis=1)
        assert total == pytest.approx(np.array(force) * length[r], rel=1e-14)
    assert loads[3:, 12:].sum(axis=1) == pytest.approx([0, 0.3 * length[1], 0], rel=1e-14)


@pytest.mark.parametrize("frame", ["space", "triad"])
def test_expressions_of_a_load_are_taken_at_the_points_and_the_time(frame):
    force, torque = ["0.4*s - t", "cos(2.1*t)", 0.3], ["s**2", -0.7, "sin(s + t)"]
    load = {"along": "all", "force": force, "torque": torque, "frame": frame}
    _, system = system_from(changed(ROD, {"rods.rod.loads": {"drive": load}}))
    state = shaken(system)
    loads, _ = of_part(system, "loads", state)
    expected = np.zeros((6, 12))
    for k in range(12):
        s, weight = 0.13 * k, 0.13 * (0.5 if k in (0, 11) else 1.0)
        triad = state.director[:, :, k] if frame == "triad" else np.eye(3)
        for row, triple in ((0, force), (3, torque)):
            values = [float(Expression(str(each))(s, state.time)) for each in triple]
            expected[row : row + 3, k] = weight * sum(
                v * axis for v, axis in zip(values, triad, strict=True)
            )
    assert loads == pytest.approx(expected, rel=1e-13, abs=1e-15)


@pytest.mark.parametrize(
    ("place", "nodes", "shares"),
    [
        ({"at": "start"}, [0], [1.0]),
        ({"at": "end"}, [11], [1.0]),
        ({"s": 0.39}, [3], [1.0]),
        ({"s": 0.416}, [3, 4], [0.8, 0.2]),
        ({"s": 11 * 0.13}, [11], [1.0]),
    ],
)
def test_a_load_at_a_place_is_shared_by_its_two_neighbours(place, nodes, shares):
    load = {**place, "force": [0.4, -0.3, 0.2], "torque": [0.7, 0.9, -1.1]}
    _, system = system_from(changed(ROD, {"rods.rod.loads": {"pull": load}}))
    loads, _ = of_part(system, "loads")
    expected = np.zeros((6, 12))
    expected[:, nodes] = np.outer([0.4, -0.3, 0.2, 0.7, 0.9, -1.1], shares)
    assert loads == pytest.approx(expected, rel=1e-12, abs=1e-14)


def test_the_share_of_a_closed_rods_last_segment_goes_to_its_first_point():
    load = {"s": 8.25 * 2 * np.pi * 0.6 / 9, "force": [0, 0, 1.7]}
    _, system = system_from(changed(TWO, {"rods.ring.loads": {"pull": load}}))
    loads, _ = of_part(system, "loads")
    assert loads[2, [20, 12]] == pytest.approx([0.75 * 1.7, 0.25 * 1.7], rel=1e-9)
    assert abs(loads).sum() == pytest.approx(1.7, rel=1e-12)


TETHERS = {
    "ends": {"from": {"rod": "rod", "at": "end"}, "to": {"rod": "ring", "s": 0.52},
             "stiffness": 0.7, "length": 0.4},
    "trap": {"from": [0.1, 0.7, -0.3], "to": {"rod": "rod", "s": 0.21}, "stiffness": 2.3},
    "rope, taut": {"from": {"rod": "ring", "s": 0.1}, "to": [5.0, 4.0, 3.0], "stiffness": 0.9,
                   "length": 1.2, "only": "pull"},
    "rope, slack": {"from": {"rod": "ring", "s": 0.1}, "to": [5.0, 4.0, 3.0], "stiffness": 0.9,
                    "length": 12.0, "only": "pull"},
    "strut, pressed": {"from": {"rod": "rod", "at": "start"}, "to": {"rod": "ring", "s": 1.3},
                       "stiffness": 0.6, "length": 17.0, "only": "push"},
    "strut, free": {"from": {"rod": "rod", "at": "start"}, "to": {"rod": "ring", "s": 1.3},
                    "stiffness": 0.6, "length": 0.2, "only": "push"},
}  # fmt: skip


def place(end, state, rods):
    """Return nodes, shares and position of an end, the obvious way."""
    if isinstance(end, list):
        return [], [], np.array(end)
    rod = rods[rods.names.index(end["rod"])]
    s = end.get("s", 0.0 if end.get("at") == "start" else rod.length)
    k, part = divmod(s / rod.spacing, 1.0)
    nodes = [int(k), (int(k) + 1) % rod.count] if part > 1e-9 else [int(k)]
    shares = [1.0 - part, part][: len(nodes)]
    nodes = [rod.first + node for node in nodes]
    return nodes, shares, sum(w * state.position[:, n] for n, w in zip(nodes, shares, strict=True))


@pytest.mark.parametrize("name", TETHERS)
def test_a_tether_is_a_spring_between_its_places(name):
    tether = TETHERS[name]
    _, system = system_from(changed(TWO, {"tethers": {"link": tether}}))
    state, rods = shaken(system), system.scene.rods
    first, second = (place(tether[key], state, rods) for key in ("from", "to"))
    d = second[2] - first[2]
    stretch = np.linalg.norm(d) - tether.get("length", 0.0)
    slack = stretch * {"pull": 1, "push": -1}.get(tether.get("only"), 0) < 0
    assert slack == (name in ("rope, slack", "strut, free"))
    force = (not slack) * tether["stiffness"] * stretch * d / np.linalg.norm(d)
    expected = np.zeros((6, rods.points))
    for (nodes, shares, _), sign in ((first, 1), (second, -1)):
        for node, share in zip(nodes, shares, strict=True):
            expected[:3, node] += sign * share * force
    loads, _ = of_part(system, "tethers", state)
    assert loads == pytest.approx(expected, rel=1e-12, abs=1e-14)
    energy = (not slack) * 0.5 * tether["stiffness"] * stretch**2
    assert system.observe(state)[1]["tether_energy"] == pytest.approx([energy], rel=1e-12)


@pytest.mark.parametrize("length", [0.0, 0.3])
def test_a_tether_between_points_at_one_place_has_no_direction(length):
    corner = ROD["rods"]["rod"]["shape"]["origin"]
    link = {"from": {"rod": "rod", "at": "start"}, "to": corner, "stiffness": 2.3, "length": length}
    _, system = system_from(changed(ROD, {"tethers": {"link": link}}))
    loads, _ = of_part(system, "tethers")
    assert not loads.any()


FLOW = ["0.3*y*z + sin(t)", "cos(1.3*z)*x", "0.7*x*y**2 + 0.2"]  # without divergence


def test_a_flow_carries_the_points_and_turns_them_with_half_its_curl():
    _, system = system_from(changed(ROD, {"fluid.flow": FLOW}))
    state = shaken(system)
    _, velocities = of_part(system, "flow", state)
    x, y, z = state.position
    u = [0.3 * y * z + np.sin(state.time), np.cos(1.3 * z) * x, 0.7 * x * y**2 + 0.2]
    curl = [
        1.4 * x * y + 1.3 * np.sin(1.3 * z) * x,
        0.3 * y - 0.7 * y**2,
        np.cos(1.3 * z) - 0.3 * z,
    ]
    assert velocities == pytest.approx(np.array([*u, *(0.5 * np.array(curl))]), rel=1e-13)


def test_a_large_scene_is_carried_like_a_small_one():
    """Points are taken in blocks: each gets what it would get alone."""
    many = changed(ROD, {"fluid.flow": FLOW, "rods.rod.shape.points": 700,
                         "rods.rod.strain_twist": [0, 0, 0]})  # fmt: skip
    _, system = system_from(many)
    _, velocities = of_part(system, "flow")
    x, y, z = system.scene.initial.position
    assert velocities[1] == pytest.approx(np.cos(1.3 * z) * x, rel=1e-12)
    assert velocities[2] == pytest.approx(0.7 * x * y**2 + 0.2, rel=1e-12)
