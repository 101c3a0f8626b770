"""States at rest: exact shapes, the digits of another program, loads, tethers, saddles."""

from dataclasses import replace

import numpy as np
import pytest
from at_rest import R0, A, case_of, moduli_of, ring
from scenes import load

from rodsim.analysis.helix import fit_helix
from rodsim.case import case_from_mapping
from rodsim.compiled.parts import LOCAL, PartList
from rodsim.rest.descent import GREATEST, SAME, Descent, descend
from rodsim.rest.forces import Forces, moved, stored_energies
from rodsim.rest.output import topology
from rodsim.rest.solve import find_rest, scales_of
from rodsim.scene.build import build_scene

pytestmark = pytest.mark.compiled  # interpreted they take hours


def scene_of(*case, **more):
    return build_scene(case_from_mapping(case_of(*case, **more)))


def energy(scene, state):
    return Forces(scene).energy(state)


def test_an_open_rod_rests_as_the_exact_helix():
    """Triads turn by phi, 2 sin(phi/2) = abs(Omega) ds, about an axis that is fixed in them, so the
    points lie on a helix of radius Omega_1/Omega^2 and rise ds Omega_3/abs(Omega) a step."""
    scene = build_scene(load("open_rod"))
    found = find_rest(scene)
    ds, omega = scene.rods[0].spacing, np.hypot(1.3, np.pi)
    turn = 2.0 * np.arcsin(0.5 * omega * ds)
    helix = fit_helix(found.state.position.T)
    assert found.failure == ""
    assert (found.growing, found.neutral) == (0, 6)
    assert energy(scene, found.state) < 1e-20
    assert helix.radius == pytest.approx(1.3 / omega**2, rel=1e-9)
    assert helix.pitch == pytest.approx(2 * np.pi / turn * ds * np.pi / omega, rel=1e-9)
    assert abs(helix.turns) == pytest.approx(75 * turn / (2 * np.pi), rel=1e-9)


RING = [
    (50, 0.005774315, 0.005774221),
    pytest.param(100, 0.005915904, 0.005915897, marks=pytest.mark.long),
]


@pytest.mark.parametrize(("points", "paper", "exact"), RING)
def test_the_papers_ring_without_contact(points, paper, exact):
    """Energies where the loads of runs are zero, and where the gradient is: another program.

    It goes through itself, Lk 0 -> 4: what the fluid does not let it, and what is said.
    """
    scene = build_scene(load("closed_ring", f"rods.ring.shape.points={points}",
                             "fluid.epsilon=0.314"))  # fmt: skip
    found, scales = find_rest(scene), scales_of(scene)
    assert found.residual < scales.tolerance
    assert (found.growing, found.neutral) == (0, 7)
    assert energy(scene, found.state) == pytest.approx(paper, abs=1e-9)
    polished = descend(Forces(scene), Descent(found.state, np.inf, 1e6 * scales.first), scales, 50,
                       SAME, lambda *_: None)  # fmt: skip
    assert energy(scene, polished.state) == pytest.approx(exact, abs=1e-9)
    before, after = (topology(scene, s)[1, 0] for s in (scene.initial, found.state))
    assert (before, after) == pytest.approx((0.0, 4.0), abs=1e-9)


@pytest.mark.long
def test_the_papers_ring_as_it_is_shipped():
    scene = build_scene(load("closed_ring", "fluid.epsilon=0.314"))
    assert energy(scene, find_rest(scene).state) == pytest.approx(0.005952175092, abs=1e-11)


def test_a_saddle_is_kept_or_left():
    """A circle beyond Michell's twist is at rest; left along its mode it ends lower, and stable."""
    scene = ring(40, [0, 0, 1.9 / R0])
    kept, left = find_rest(scene, saddle=True), find_rest(scene)
    assert (kept.growing, kept.saddles) == (2, 0)
    assert left.growing == 0
    assert left.saddles >= 1
    assert energy(scene, left.state) < 0.5 * energy(scene, kept.state)


def test_a_planar_figure_eight():
    """The elastica E L/a = 32 K^2 (k^2 - 1/2) = 56.2198, less O(ds^2): digits of another program.

    In its plane nothing grows; in space one mode does, and eight cost nothing: six rigid motions,
    the register, and the slide along itself.
    """
    length, points = 2 * np.pi * R0, 50
    size = length / 6.1  # of the lemniscate, so that it is as long as the rod
    shape = {"kind": "curve", "position": [0, "c*sin(2*u)/2", "c*sin(u)"], "from": 0.03,
             "to": "0.03 + 2*pi", "closed": True, "points": points, "length": length}  # fmt: skip
    scene = scene_of(shape, moduli_of(80.0), [0, 0, 0], parameters={"c": size}, plane="yz")
    planar = find_rest(scene)
    assert (planar.growing, planar.neutral) == (0, 4)
    spatial = find_rest(replace(scene, planar=False, initial=planar.state), saddle=True)
    assert (spatial.growing, spatial.neutral) == (1, 8)
    scales = scales_of(scene)
    start = Descent(planar.state, np.inf, 1e6 * scales.first)
    exact = descend(Forces(scene), start, scales, 50, SAME, lambda *_: None).state
    assert energy(scene, exact) * length / A == pytest.approx(56.006979, rel=1e-6)


def hanging(**tether):
    """Return the scene of a heavy rod on a tether from one end, not yet hanging straight down."""
    shape = {"kind": "straight", "points": 21, "length": 2.3,
             "rotate": {"axis": [1, 0.2, 0], "degrees": 150}}  # fmt: skip
    data = case_of(shape, moduli_of(), [0, 0, 0])
    data["rods"]["rod"]["loads"] = {"weight": {"along": "all", "force": [0, 0, -1.7e-4]}}
    data["tethers"] = {"rope": {"from": [0.3, 0.1, 0.9], "to": {"rod": "rod", "at": "start"},
                                "stiffness": 2.2e-3, "length": 0.6} | tether}  # fmt: skip
    return build_scene(case_from_mapping(data))


@pytest.mark.parametrize("only", [{}, {"only": "pull"}])
def test_a_heavy_rod_hangs_from_its_tether(only):
    """Straight down from where the tether is held, which is longer by weight/stiffness."""
    scene = hanging(**only)
    found = find_rest(scene)
    assert found.failure == ""
    top, end = found.state.position[:, 0], found.state.position[:, -1]
    stretch = 1.7e-4 * 2.3 / 2.2e-3
    # Positions to tolerance * a/L^2 over the softest stiffness, the pendulum's weight/length.
    assert top == pytest.approx([0.3, 0.1, 0.9 - 0.6 - stretch], abs=1e-7)
    assert end[:2] == pytest.approx([0.3, 0.1], abs=1e-7)
    assert end[2] < top[2]
    assert (found.growing, found.neutral) == (0, 1)  # it may turn about itself


def test_a_pendulum_on_its_head_is_a_saddle_and_is_left():
    """Above its tether a heavy rod is at rest and falls in four ways: the strut, the rod, each in
    two directions. Left, it hangs."""
    shape = {"kind": "straight", "points": 11, "length": 1.3, "origin": [0, 0, 0.5]}
    data = case_of(shape, moduli_of(), [0, 0, 0])
    data["rods"]["rod"]["loads"] = {"weight": {"along": "all", "force": [0, 0, -1.7e-4]}}
    data["tethers"] = {"strut": {"from": [0, 0, 0], "to": {"rod": "rod", "at": "start"},
                                 "stiffness": 2.2e-3, "length": 0.6}}  # fmt: skip
    scene = build_scene(case_from_mapping(data))
    kept, left = find_rest(scene, saddle=True), find_rest(scene)
    assert kept.growing == 4
    assert left.growing == 0
    assert left.state.position[2, -1] < -1.7


@pytest.mark.parametrize("length", [0.4, 1.9])
def test_the_stiffness_of_a_tether_is_the_derivative_of_its_loads(length):
    """Taut and pushed together, between places that lie between points."""
    points = {"rod": "rod", "s": 0.3}, {"rod": "rod", "s": 1.9}
    scene = hanging(**{"from": points[0], "to": points[1], "length": length})
    alone = PartList(part for part in scene.parts if part.name == "tethers")
    forces = Forces(replace(scene, parts=alone))
    stiffness, step = forces.stiffness(scene.initial).toarray(), 1e-4
    for number in np.flatnonzero(abs(stiffness).sum(axis=0)):
        change = np.zeros((6, scene.rods.points))
        change.flat[number] = step
        ends = (forces.loads(moved(scene.initial, side * change)).ravel() for side in (1, -1))
        slope = np.subtract(*ends) / (2.0 * step)
        assert abs(slope + stiffness[:, number]).max() < 1e-7 * abs(stiffness).max()  # step^2


def test_a_force_that_hides_what_it_couples_is_found_out():
    """Its stiffness would be taken for that of neighbours, and modes counted wrong."""
    scene = hanging()
    assert Forces(scene).conservative_at(scene.initial)
    local = [replace(part, statics=LOCAL) if part.name == "tethers" else part
             for part in scene.parts]  # fmt: skip
    points = {"rod": "rod", "s": 0.3}, {"rod": "rod", "s": 1.9}
    far = hanging(**{"from": points[0], "to": points[1], "length": 0.4})
    assert Forces(far).conservative_at(far.initial)
    hiding = [
        replace(part, statics=LOCAL) if part.name == "tethers" else part for part in far.parts
    ]
    assert Forces(replace(scene, parts=PartList(local))).conservative_at(scene.initial)
    assert not Forces(replace(far, parts=PartList(hiding))).conservative_at(far.initial)


def test_a_shape_that_goes_through_the_wall_is_no_state_at_rest():
    """A wall holds back the fluid, not the rod."""
    below = 0.9 - 0.6 - 2.3  # where the end of the heavy rod would hang, and lower
    found = find_rest(replace(hanging(), wall=below + 0.3))
    assert "goes through the wall" in found.failure
    assert find_rest(replace(hanging(), wall=below - 0.5)).failure == ""


def test_what_is_pushed_and_not_held_never_rests():
    scene = hanging()
    free = replace(scene, parts=PartList(p for p in scene.parts if p.name != "tethers"))
    found = find_rest(free)
    assert "nothing holds the scene" in found.failure
    assert found.steps == 0


def test_a_follower_has_no_energy_and_no_count():
    """Modes are not counted where loads turn with the rod: the stiffness is not symmetric."""
    scene = hanging()
    data = case_of({"kind": "straight", "points": 11, "length": 1.3}, moduli_of(), [0.4, 0, 0])
    load = {"at": "end", "torque": [2e-4, 0, 0], "frame": "triad"}
    back = {"at": "start", "torque": [-2e-4, 0, 0], "frame": "triad"}
    data["rods"]["rod"]["loads"] = {"end": load, "start": back}
    found = find_rest(build_scene(case_from_mapping(data)))
    assert found.failure == ""
    assert found.growing is None
    assert find_rest(scene).growing == 0


def test_the_last_steps_do_not_leave_a_saddle_that_is_kept():
    """A figure eight opened by a little twist, at rest for the exact gradient; then the paper's.

    Down in energy it would go to the circle, E L/a = 19.7; what is kept must be what was counted.
    """
    length, size = 2 * np.pi * R0, {"c": 2 * np.pi * R0 / 6.1}
    shape = {"kind": "curve", "position": [0, "c*sin(2*u)/2", "c*sin(u)"], "from": 0.03,
             "to": "0.03 + 2*pi", "closed": True, "points": 60, "length": length}  # fmt: skip
    planar = find_rest(scene_of(shape, moduli_of(), [0, 0, 0], parameters=size, plane="yz"))
    scene = scene_of(shape, moduli_of(), [0, 0, 0.05 / R0], parameters=size)
    scales = scales_of(scene)
    start = Descent(planar.state, np.inf, GREATEST * scales.first)
    near = descend(Forces(scene), start, scales, 20, np.inf, lambda *_: None)
    found = find_rest(replace(scene, initial=near.state), saddle=True)
    assert (near.failure, found.failure, found.growing) == ("", "", 1)
    bending = stored_energies(scene, found.state)["bending"]
    assert bending * length / A == pytest.approx(55.844, abs=0.01)
