"""States at rest, and their stability, where rods are held by bodies that are fixed or free."""

from math import log, pi, sqrt, tan

import numpy as np
import pytest

pytest.importorskip("scipy")

from acting import changed
from scenes import system_from
from scipy.optimize import brentq

from rodsim.errors import UsageError
from rodsim.rest.forces import Forces, stored_energies
from rodsim.rest.rates import mobility, rates_of
from rodsim.rest.solve import find_rest
from rodsim.rest.stability import stability_of
from rodsim.rest.start import start_from_case

pytestmark = pytest.mark.compiled  # seconds each, minutes without the JIT
MODULI = {"bending": 1.3, "twisting": 0.9, "shear": 52.0, "stretch": 52.0}
CLAMPED, TO_CELL = {"hold": "clamped"}, {"hold": "clamped", "to": "cell"}
HOOK = {"hold": "clamped", "to": "cell", "hook": {"bending": 0.83, "twisting": 0.6}}
L, R = 6.0, 0.9
COLUMN = {  # a ball on a column that stands on the ground
    "fluid": {"viscosity": 0.3, "epsilon": 0.5},
    "rods": {"rod": {"shape": {"kind": "straight", "points": 31, "length": L}, "moduli": MODULI,
                     "start": CLAMPED, "end": TO_CELL}},
    "bodies": {"cell": {"shape": {"kind": "sphere", "radius": R, "points": 20,
                                  "origin": [0, 0, L + R]}}},
    "time": {"end": 2.0},
}  # fmt: skip
HANGING = changed(COLUMN, {  # a bent rod on a hinge, a ball beside its end
    "rods.rod.shape": {"kind": "straight", "points": 21, "length": 4.0,
                       "rotate": {"axis": [0, 1, 0], "degrees": 150}},
    "rods.rod.strain_twist": [0.2, 0.1, 0.05],
    "rods.rod.start": {"hold": "hinged"},
    "bodies.cell.shape.origin": [2.0 + R, 0, -2.0 * sqrt(3.0)],
    "bodies.cell.force": [0, 0, -0.4],
})  # fmt: skip
THRESHOLD = 1.3 * brentq(lambda k: k * R * tan(k * L) - 1.0, 1e-3, pi / 2 / L - 1e-6) ** 2


def scene_of(data):
    return system_from(data)[1].scene


def slope(forces, state, change):
    """Return the change of the free loads for a change of the state: central, 1e-4 of it."""
    sides = [forces.loads(forces.moved(state, side * 1e-4 * change)) for side in (0.5, -0.5)]
    return (sides[0] - sides[1]).ravel()[forces.free] / 1e-4


def free_change(forces, seed=1):
    change = np.random.default_rng(seed).normal(size=(6, forces.scene.nodes))
    change[:3] *= forces.scene.rods.spacing.min()
    change.flat[np.setdiff1d(np.arange(change.size), forces.free)] = 0.0
    return change


@pytest.mark.parametrize(("share", "growing"), [(0.98, 0), (1.02, 2)])
def test_a_ball_on_a_column_buckles_where_theory_has_it(share, growing):
    """y'' = -k^2 (y - delta) under a dead load at L + R, rigid from L on: k R tan(k L) = 1.

    Shear, stretch and the lattice change it by 0.3 %; two modes, one for each direction."""
    force = {"bodies.cell.force": [0, 0, -share * THRESHOLD]}
    found = find_rest(scene_of(changed(COLUMN, force)), saddle=True)
    assert found.failure == ""
    assert found.growing == growing


@pytest.fixture(scope="module")
def hanging():
    """The scene, its state at rest."""
    scene = scene_of(HANGING)
    return scene, find_rest(scene)


def test_a_ball_hangs_below_the_hinge(hanging):
    """No torque about the hinge is left; that of its turn about the vertical costs nothing."""
    found = hanging[1]
    assert found.failure == ""
    assert (found.growing, found.neutral) == (0, 1)
    hinge, ball = found.state.position[:, 0], found.state.position[:, -1]
    assert ball[:2] == pytest.approx(hinge[:2], abs=1e-7)
    assert ball[2] < -4.0
    end = found.state.position[:, 20]
    assert np.linalg.norm(end - ball) == pytest.approx(R, rel=1e-12)  # still on the surface
    assert abs(end[:2]).max() > 0.3


@pytest.mark.parametrize("exact", [True, False])
def test_the_stiffness_is_the_derivative_of_the_loads(hanging, exact):
    """Central differences of 1e-4: 1e-8 of it; the rows of a body are no transposed columns."""
    scene, found = hanging
    forces = Forces(scene, exact=exact)
    matrix, change = forces.stiffness(found.state), free_change(forces)
    expected = matrix @ change.ravel()[forces.free]
    assert -slope(forces, found.state, change) == pytest.approx(
        expected, abs=3e-7 * abs(expected).max()
    )


def test_tethers_hooks_and_contact_of_a_free_body_are_in_its_stiffness():
    """Out of rest, where all of them pull: 1e-4 of a spacing, so 1e-8 of it by differences."""
    scene = scene_of(changed(HANGING, {
        "rods.rod.end": HOOK, "contact": {"diameter": 0.9}, "fluid.wall": {"z": -4.7},
        "tethers": {"aside": {"from": {"body": "cell", "at": [0, 0.9, 0]}, "stiffness": 0.7,
                              "to": {"rod": "rod", "s": 1.1}}},
    }))  # fmt: skip
    forces = Forces(scene)
    rng, way = np.random.default_rng(4), np.zeros((6, scene.nodes))
    way[:, -1] = 0.05 * rng.normal(size=6)
    state = forces.moved(scene.initial, way)
    change = free_change(forces)
    expected = forces.stiffness(state) @ change.ravel()[forces.free]
    found = -slope(forces, state, change)
    own = np.flatnonzero(forces.free % scene.nodes == scene.nodes - 1)
    assert abs(expected[own]).min() > 1e-3
    assert found == pytest.approx(expected, abs=3e-7 * abs(expected).max())


@pytest.mark.parametrize("holder", ["space", "cell"])
def test_a_hook_bends_until_its_torque_is_that_of_the_load(holder):
    """k theta = F x of a rod on a hook, whose load hangs aside at x; energy 1/2 k theta^2."""
    k, load = 0.83, 0.21
    scene = scene_of(changed(COLUMN, {
        "rods.rod.start": {**HOOK, "to": holder, "hook": {"bending": k, "twisting": 0.6}},
        "rods.rod.end": None, "rods.rod.shape.length": 3.0, "rods.rod.moduli.bending": 900.0,
        "rods.rod.loads": {"tip": {"at": "end", "force": [load, 0, 0]}},
        "bodies.cell.shape.origin": [0, 0, -R], "bodies.cell.motion": "fixed",
    }))  # fmt: skip
    found = find_rest(scene)
    assert (found.failure, found.growing) == ("", 0)
    start, end = found.state.position[:, 0], found.state.position[:, 30]
    tangent = found.state.director[2, :, 0]
    theta = np.arctan2(tangent[0], tangent[2])
    assert 0.3 < theta < 0.9
    moment = load * (end[2] - start[2])
    assert k * theta == pytest.approx(moment, rel=1e-6)  # residual 1e-9 of 900/3
    stored = stored_energies(scene, found.state)["hook"]
    assert stored == pytest.approx(0.5 * k * theta**2, rel=1e-9)


def test_a_fixed_body_holds_as_the_ground_does():
    load = {"tip": {"at": "start", "force": [0.03, 0.0, -0.02]}}
    ground = changed(COLUMN, {"rods.rod.start": None, "rods.rod.end": CLAMPED,
                              "rods.rod.loads": load, "bodies": None})  # fmt: skip
    body = changed(COLUMN, {"rods.rod.start": None, "rods.rod.loads": load,
                            "bodies.cell.motion": "fixed"})  # fmt: skip
    found = [find_rest(scene_of(data)) for data in (ground, body)]
    assert [(rest.failure, rest.growing) for rest in found] == [("", 0)] * 2
    here, there = (rest.state.position[:, :31] for rest in found)
    assert abs(here[0, 0]) > 0.3
    assert there == pytest.approx(here, abs=1e-9)


def test_a_ball_lies_on_the_wall_where_weight_and_contact_are_equal():
    """(64/5) A R (s/d) q^(5/2) = F; it slides and rolls for nothing, and a rod floats: 5 + 6."""
    weight, d = 0.37, 1.213 * 0.5
    scene = scene_of(changed(COLUMN, {
        "fluid.wall": {"z": -R}, "contact": {}, "rods.rod.start": None, "rods.rod.end": None,
        "rods.rod.shape.origin": [7, 0, 0.2], "bodies.cell.force": [0, 0, -weight],
        "bodies.cell.shape.origin": [0, 0, 0.29],
    }))  # fmt: skip
    found = find_rest(scene)
    assert found.failure == ""
    s, A = found.state.position[2, -1], 20.0 * 1.3 / d**3
    force = 12.8 * A * R * s / d * (1.0 - (2.0 * s / d) ** 2) ** 2.5
    assert force == pytest.approx(weight, rel=1e-7)
    assert (found.growing, found.neutral) == (0, 11)


@pytest.mark.parametrize("end", [TO_CELL, HOOK])
def test_motions_near_rest_are_those_of_stiffness_and_mobility(end):
    """dz/dt = -A K z against the velocities of a run, of a displacement of 1e-5."""
    force = [0.1 * THRESHOLD, 0, -0.5 * THRESHOLD]
    changes = {"bodies.cell.force": force, "rods.rod.end": end}
    system = system_from(changed(COLUMN, changes))[1]
    state = find_rest(system.scene).state
    forces = Forces(system.scene, exact=False)
    change = 1e-5 * free_change(forces)
    moves = mobility(system.scene, state, forces.free)
    assert np.linalg.eigvalsh(0.5 * (moves + moves.T)).min() > 0.0
    assert moves == pytest.approx(moves.T, abs=1e-9 * abs(moves).max())
    expected = -moves @ (forces.stiffness(state) @ change.ravel()[forces.free])
    sides = [
        system.velocities(0.0, forces.moved(state, side * change), system.zeros(), system.zeros())
        for side in (0.5, -0.5)
    ]
    found = (sides[0] - sides[1])[forces.free]
    assert found == pytest.approx(expected, abs=1e-6 * abs(expected).max())


def test_a_clamped_rod_relaxes_as_another_program_has_it():
    """rate = 7.36 B/(zeta L^4), zeta = 4 pi mu/(ln(L/a) + 1/2), a = 0.6065 epsilon."""
    scene = scene_of(changed(COLUMN, {
        "rods.rod.shape.length": 10.0, "rods.rod.end": None, "bodies": None,
        "rods.rod.moduli": {"bending": 1.3, "twisting": 1.3, "shear": 520.0, "stretch": 520.0},
        "fluid.epsilon": 2.0 / 3.0,
    }))  # fmt: skip
    forces = Forces(scene)
    moves = mobility(scene, scene.initial, forces.free)
    found = rates_of(forces.stiffness(scene.initial), moves)
    zeta = 4.0 * pi * 0.3 / (log(10.0 / (0.6065 * 2.0 / 3.0)) + 0.5)
    scaled = -found.values.real * zeta * 10.0**4 / 1.3
    near = scaled[abs(scaled / 7.36 - 1.0) < 5e-3]
    assert len(near) == 2


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"rods.rod.end.motor": {"rate": 0.7}}, "the motor of rod.end drives for ever"),
        ({"rods.rod.end.hook": {"bending": 0.3}}, "the hook of rod.end is stiff in twist"),
        ({"bodies.cell.motion": {"velocity": [0.2, 0, 0]}}, "'cell' has a given motion: at rest"),
    ],
)
def test_what_never_rests_is_refused_by_name(changes, said):
    case, system = system_from(changed(COLUMN, changes))
    assert said in find_rest(system.scene).failure
    with pytest.raises(UsageError, match=said):
        stability_of(start_from_case(case), 3, False)
