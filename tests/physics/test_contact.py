"""Contact: its forces against its energy and against lines; what it must leave alone."""

import numpy as np
import pytest
from acting import changed, of_part
from scenes import system_from

from rodsim.compiled.parts import FORCE
from rodsim.scene.evaluation import loads_of

MODULI = {"bending": [0.36, 0.42], "twisting": 0.29, "shear": 21.0, "stretch": 17.0}
LYING = {"axis": [0, 1, 0], "degrees": 90}
TANGLE = {  # a coil through a ring above a wall: pairs of all kinds, and a wall
    "fluid": {"viscosity": 1.3, "epsilon": 0.31, "wall": {"z": -1.02}},
    "rods": {
        "coil": {
            "shape": {"kind": "helix", "radius": 0.5, "pitch": 0.33, "length": 7.3, "points": 71,
                      "rotate": LYING},
            "moduli": MODULI,
        },
        "ring": {
            "shape": {"kind": "ring", "radius": 0.81, "points": 60, "rotate": LYING,
                      "origin": [0.41, 0.03, -0.04]},
            "moduli": {**MODULI, "bending": 0.23},
        },
    },
    "contact": {"diameter": 0.39, "strength": 23.0, "exclusion": 0.71},
    "time": {"end": 0.1},
}  # fmt: skip


def tangle(**changes):
    return system_from(changed(TANGLE, {k.replace("__", "."): v for k, v in changes.items()}))[1]


def forces(system, position=None):
    """Return the force (3, N) of contact, pairs and wall, on all points."""
    state = system.scene.initial
    if position is not None:
        state = type(state)(state.time, position, state.director, state.tracer, state.work)
    loads = sum(of_part(system, name, state)[0] for name in ("contact", "contact_wall"))
    assert not loads[3:].any()
    return loads[:3]


def energy(system, position):
    (part,) = (p for p in system.scene.parts if p.name == "contact")
    state = system.scene.initial
    state = type(state)(state.time, position, state.director, state.tracer, state.work)
    return part.observe(state, part.row, system.scene)["contact_energy"]


def test_the_force_is_the_gradient_of_the_energy():
    """Sixth-order differences; where a pair crosses the diameter the third derivative jumps."""
    system = tangle()
    X, h = system.scene.initial.position, 1e-5
    force, rng = forces(system), np.random.default_rng(5)
    assert force[:2].any(axis=0).sum() > 100
    assert of_part(system, "contact_wall")[0].any(axis=0).sum() == 5
    for _ in range(12):
        way = rng.normal(size=X.shape)
        sums = [
            weight * (energy(system, X + n * h * way).sum() - energy(system, X - n * h * way).sum())
            for n, weight in ((1, 45), (2, -9), (3, 1))
        ]
        slope = sum(sums) / (60.0 * h)
        assert slope == pytest.approx(-(force * way).sum(), abs=1e-10 * abs(force * way).sum())


def test_pairs_have_no_net_force_and_no_net_torque_and_the_wall_has_one():
    system = tangle()
    X = system.scene.initial.position
    pairs = of_part(system, "contact")[0][:3]
    size = abs(pairs).max()
    assert pairs.sum(axis=1) == pytest.approx([0, 0, 0], abs=1e-14 * size)
    torque = np.cross(X, pairs, axis=0).sum(axis=1)
    assert torque == pytest.approx([0, 0, 0], abs=1e-14 * size * abs(X).max())
    seen = system.observe(system.scene.initial)[1]
    wall = of_part(system, "contact_wall")[0][:3]
    assert wall[2].sum() > 0.0
    assert seen["external_force"] == pytest.approx(wall.sum(axis=1), rel=1e-13)


def test_energy_and_forces_turn_with_the_scene():
    system, free = tangle(), {"fluid__wall": None}
    axis, turned = {"axis": [0.4, -0.2, 1.1], "degrees": 77}, tangle(**free)
    X = turned.scene.initial.position
    from rodsim.scene.shapes import rotation_matrix

    R = rotation_matrix(axis["axis"], np.radians(axis["degrees"]))
    there = R @ X + np.array([[3.0], [-2.0], [5.0]])
    assert energy(turned, there) == pytest.approx(energy(turned, X), rel=1e-12)
    pairs = of_part(system, "contact")[0][:3]
    state = turned.scene.initial
    moved = type(state)(0.0, there, state.director, state.tracer, state.work)
    force = of_part(turned, "contact", moved)[0][:3]
    assert force == pytest.approx(R @ pairs, abs=1e-11 * abs(pairs).max())


def test_the_order_of_rods_and_of_points_does_not_matter():
    system = tangle()
    rods = TANGLE["rods"]
    other = tangle(rods={name: rods[name] for name in reversed(rods)})
    parts = np.split(forces(other), [60], axis=1)
    swapped = np.concatenate(parts[::-1], axis=1)
    assert swapped == pytest.approx(forces(system), abs=1e-13 * abs(swapped).max())
    X = system.scene.initial.position
    ring = np.roll(X[:, 71:], 17, axis=1)[:, ::-1]  # begun elsewhere, the other way round
    there = np.ascontiguousarray(np.concatenate([X[:, :71], ring], axis=1))
    found = forces(system, there)[:, 71:]
    assert np.roll(found[:, ::-1], -17, axis=1) == pytest.approx(
        forces(system)[:, 71:], abs=1e-13 * abs(found).max()
    )


A = 23.0 * 0.36 / 0.39**3  # of two coils; the larger of their bending moduli is 0.42


def lines(distance, angle, spacing=0.39 / 5, z=None):
    """Two straight rods at a distance, one turned about the line between their middles."""
    n = 141
    shape = {"kind": "straight", "points": n, "spacing": spacing}
    half, turn = 0.5 * (n - 1) * spacing, np.radians(angle)
    wall = {} if z is None else {"wall": {"z": -z}}
    return system_from({
        **TANGLE, "fluid": {"viscosity": 1.3, "epsilon": 0.31, **wall},
        "rods": {
            "one": {"shape": {**shape, "origin": [0, 0, -half]}, "moduli": MODULI},
            "two": {"shape": {**shape, "rotate": {"axis": [1, 0, 0], "degrees": -angle},
                              "origin": [distance, -half * np.sin(turn), -half * np.cos(turn)]},
                    "moduli": {**MODULI, "bending": 0.71}},
        },
    })[1]  # fmt: skip


STIFFNESS = 23.0 * 0.42 / 0.39**3  # of the softer rod's larger bending modulus


@pytest.mark.parametrize("h", [0.6, 0.75, 0.85])
def test_parallel_lines_push_each_other_with_the_pressure_of_the_formula(h):
    """p = (32/35) 7 A (h/d) q^(5/2) per length; the sum over points differs by 1 % at d = 5 ds."""
    system = lines(h * 0.39, 0.0)
    force = of_part(system, "contact")[0][0, 60:80].mean() / (0.39 / 5)
    q = 1.0 - h * h
    assert force == pytest.approx(-6.4 * STIFFNESS * h * q**2.5, rel=1e-2)


@pytest.mark.parametrize("angle", [90, 50])
@pytest.mark.parametrize("h", [0.55, 0.7, 0.85])
def test_crossing_lines_push_each_other_with_the_force_of_the_formula(h, angle):
    """F = 2 pi A h q^3/sin(angle), energy (pi/4) A d^2 q^4/sin(angle)."""
    system = lines(h * 0.39, angle)
    force = of_part(system, "contact")[0][0, :141].sum()
    q, sine, d = 1.0 - h * h, np.sin(np.radians(angle)), 0.39
    assert force == pytest.approx(-2 * np.pi * STIFFNESS * h * d * q**3 / sine, rel=2e-2)
    stored = energy(system, system.scene.initial.position)
    assert stored.sum() == pytest.approx(np.pi / 4 * STIFFNESS * d * d * q**4 / sine, rel=2e-2)
    assert stored[0] == pytest.approx(stored[1], rel=1e-12)


@pytest.mark.parametrize("angle", [90, 50])
def test_crossing_lines_push_each_other_as_the_formula_in_the_mean_over_their_points(angle):
    """At 0.9 d and d = 5 ds a single force is off by up to 1 %, by where points lie beside points.

    The mean over all places of both lines' points is the double integral; over 4 x 4 places what is
    left are waves of a quarter of the spacing.
    """
    system, turn, places = lines(0.9 * 0.39, angle), np.radians(angle), np.arange(4) / 4 * 0.39 / 5
    along = np.array([[0.0, 0.0, 1.0], [0.0, np.sin(turn), np.cos(turn)]])
    start, found = system.scene.initial.position, []
    for u in places:
        for v in places:
            shift = np.repeat([u * along[0], v * along[1]], 141, axis=0).T
            found.append(forces(system, np.ascontiguousarray(start + shift))[0, :141].sum())
    h, q = 0.9 * 0.39, 1.0 - 0.9**2
    expected = -2 * np.pi * STIFFNESS * h * q**3 / np.sin(turn)
    assert np.ptp(found) > 5e-3 * abs(expected)
    assert np.mean(found) == pytest.approx(expected, rel=2e-4)


@pytest.mark.parametrize("h", [0.6, 0.8])
def test_a_wall_pushes_a_rod_as_its_mirror_image_would(h):
    """A rod above a wall, and two rods of its stiffness twice as far apart."""
    flat = {"shape": {"kind": "straight", "points": 141, "spacing": 0.06,
                      "rotate": {"axis": [1, 0, 0], "degrees": 90},
                      "origin": [0, 0, 0.5 * h * 0.39]}, "moduli": MODULI}  # fmt: skip
    case = {**TANGLE, "rods": {"one": flat}, "fluid": {**TANGLE["fluid"], "wall": {"z": 0.0}}}
    system = system_from(case)[1]
    wall = of_part(system, "contact_wall")[0][2]
    mirror = {**flat, "shape": {**flat["shape"], "origin": [0, 0, -0.5 * h * 0.39]}}
    free = {**case, "rods": {"one": flat, "two": mirror}, "fluid": {"viscosity": 1.3, "epsilon": 1}}
    pair = system_from(free)[1]
    between = of_part(pair, "contact")[0][2, :141]
    assert wall[20:120] == pytest.approx(between[20:120], rel=5e-3)  # d = 6.5 ds
    assert wall[:3] == pytest.approx([0.5 * wall[70], wall[70], wall[70]], rel=1e-9)
    stored = energy(system, system.scene.initial.position)
    whole = 0.5 * energy(pair, pair.scene.initial.position).sum()
    assert stored[0] == pytest.approx(whole, rel=2e-2)  # the ends see half of each other


def test_strands_of_a_plane_push_each_other_in_it():
    flat = {"kind": "straight", "points": 30, "spacing": 0.1}
    case = {**TANGLE, "plane": "yz", "fluid": {"viscosity": 1.3, "epsilon": 0.31}, "rods": {
        "one": {"shape": flat, "moduli": MODULI},
        "two": {"shape": {**flat, "origin": [0, 0.3, 0.04]}, "moduli": MODULI},
    }}  # fmt: skip
    system = system_from(case)[1]
    loads = loads_of(system.scene, system.scene.initial)
    assert loads[1].any()
    assert not loads[0].any()


def test_only_what_is_asked_for_pushes():
    """No pair farther than d, none within the exclusion; between: none of one rod."""
    apart = {"rods__ring__shape__origin": [9.0, 9.0, 9.0], "fluid__wall": None}
    alone = tangle(**apart)
    assert of_part(alone, "contact")[0][:, :71].any()  # the coil touches itself
    assert not of_part(tangle(**apart, contact__pairs="between"), "contact")[0].any()
    between = of_part(tangle(contact__pairs="between"), "contact")[0]
    both = of_part(tangle(), "contact")[0]
    assert between.any()
    assert between[:3, :71].sum(axis=1) == pytest.approx(both[:3, :71].sum(axis=1), rel=1e-10)
    long = tangle(**apart, contact__exclusion=7.4)
    assert not of_part(long, "contact")[0].any()
    assert [part.name for part in long.scene.parts.of(FORCE)] == ["elastic", "contact"]


@pytest.mark.parametrize(("h", "speed"), [(0.1, 16.7687), (0.3, 110.318), (0.6, 256.150)])
def test_without_contact_lines_close_ever_more_slowly(h, speed):
    """-(p/(4 pi mu)) ln(1 + h^2/eps^2), p on one line and -p on the other: never 0."""
    n, ds, eps, p = 4001, 0.1, 0.3, 2e-3
    from rodsim import velocity

    z = ds * (np.arange(n) - n // 2)
    sources = np.zeros((2 * n, 3))
    sources[:, 2], sources[n:, 0] = np.tile(z, 2), h
    loads = np.zeros((2 * n, 3))
    loads[:n, 0], loads[n:, 0] = p * ds, -p * ds
    targets = sources[[n // 2, n + n // 2]]
    u, _ = velocity(targets, sources, loads, np.zeros_like(loads), eps, 1e-6)
    assert u[0, 0] - u[1, 0] == pytest.approx(speed, rel=1e-4)  # lines of 400, not infinite
    exact = p / (4e-6 * np.pi) * np.log1p((h / eps) ** 2)
    assert exact == pytest.approx(speed, rel=1e-5)
