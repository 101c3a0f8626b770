"""Scenes with a plane wall: a reference trajectory, energy, symmetries, the fastest rate."""

import acting
import numpy as np
import pytest
from scenes import difference, last, reference
from test_fastest_rate import largest_eigenvalue

from rodsim.case import case_from_mapping
from rodsim.errors import CaseError
from rodsim.integrators.limits import stability
from rodsim.integrators.make import make_integrator
from rodsim.run.gap import Gap
from rodsim.scene.at_wall import mirror_gap
from rodsim.scene.build import build_scene
from rodsim.scene.system import RodSystem

pytestmark = pytest.mark.compiled

EPS = 0.23
ROD = {  # of tests/reference/wall-rod.txt
    "fluid": {"viscosity": 1.3, "epsilon": EPS, "wall": {"z": 0.0}},
    "rods": {
        "rod": {
            "shape": {
                "kind": "straight",
                "points": 41,
                "spacing": 0.09,
                "rotate": {"axis": [0, 1, 0.3], "degrees": 84},
                "origin": [0.2, -0.3, 0.41],
            },
            "moduli": {
                "bending": [0.36, 0.42],
                "twisting": 0.29,
                "shear": [21.0, 19.0],
                "stretch": 17.0,
            },
            "strain_twist": [0.9, 0.25, 0.7],
        }
    },
    "time": {"end": 4.0, "tolerance": 1e-8},
}


def changed(**paths):
    """Return the case with some values set, ``__`` between keys; None takes a key out."""
    changes = {path.replace("__", "."): value for path, value in paths.items()}
    return case_from_mapping(acting.changed(ROD, changes))


def states(case):
    """Run a case in memory; return its states at the ends of steps, and the integrator."""
    system = RodSystem(build_scene(case))
    integrator = make_integrator(case.time, system)
    return integrator.steps(system.scene.initial, case.time.end), system, integrator


def end(case):
    return last(states(case)[0]).end


def energy(system, state):
    _, seen = system.observe(state, np.zeros((6, state.position.shape[1])))
    return sum(seen[f"{part}_energy"].sum() for part in ("bending", "twisting", "shear", "stretch"))


@pytest.fixture(scope="module")
def at_wall():
    return end(changed())


def test_the_rod_at_a_wall_ends_as_that_of_a_separate_program(at_wall):
    """RK4, extrapolated, good to 2e-11, ten digits printed. At 1e-8 rkc comes within 1e-8."""
    position, director = reference("wall-rod")
    assert at_wall.position == pytest.approx(position, abs=1e-6)
    assert at_wall.director == pytest.approx(director, abs=1e-6)


def test_without_the_wall_it_ends_elsewhere():
    free = end(changed(fluid__wall=None))
    assert abs(free.position - reference("wall-rod")[0]).max() > 0.02  # 0.025: the wall counts


@pytest.mark.parametrize("blob", ["algebraic7", "algebraic9"])
def test_energy_falls_at_every_step_from_066_epsilon_on(blob):
    low = [0.2, -0.3, 0.66 * EPS]  # point 0 is the lowest
    case = changed(rods__rod__shape__origin=low, fluid__blob=blob, time__tolerance=1e-6)
    steps, system, _ = states(case)
    first = system.scene.initial
    lowest = mirror_gap(system.scene, first.position)[0] / 2
    found = [energy(system, first)]
    for step in steps:
        found.append(energy(system, step.end))
        assert step.end.position[2].min() > 0.0
    assert lowest == pytest.approx(0.66 * EPS, rel=1e-12)
    assert len(found) > 30
    assert (np.diff(found) < 0.0).all()
    assert found[-1] < 0.5 * found[0]


def test_a_wall_far_away_is_no_wall():
    """What a wall at distance H changes falls as 1/H (a force-free rod: faster)."""
    free, far = end(changed(fluid__wall=None)), end(changed(fluid__wall={"z": -1e5}))
    position, director = difference(free, far)
    assert max(position, director) < 2e-8  # two runs at a tolerance of 1e-8


def test_a_wall_at_another_height_is_the_scene_shifted(at_wall):
    up = 1.75
    shifted = end(changed(fluid__wall={"z": up}, rods__rod__shape__origin=[0.2, -0.3, 0.41 + up]))
    assert shifted.position - [[0], [0], [up]] == pytest.approx(at_wall.position, abs=1e-7)
    assert shifted.director == pytest.approx(at_wall.director, abs=1e-7)


def flat(**paths):
    """A rod in the plane of y and z, bent away from the wall, then above it."""
    shape = {"kind": "straight", "points": 31, "spacing": 0.09, "origin": [0, 0.2, 0.35],
             "rotate": {"axis": [1, 0, 0], "degrees": -77}}  # fmt: skip
    plain = {"rods__rod__shape": shape, "rods__rod__strain_twist": [0.9, 0.0, 0.0],
             "time__end": 1.5, "time__tolerance": 1e-7}  # fmt: skip
    return changed(**plain | paths)


@pytest.mark.parametrize("blob", ["algebraic7", "algebraic9"])
def test_a_planar_scene_is_the_spatial_one(blob):
    fixed = {"end": 1.5, "integrator": "rk4", "step": 0.01}
    spatial, planar = (
        end(flat(plane=plane, fluid__blob=blob, time=fixed)) for plane in (None, "yz")
    )
    assert not planar.position[0].any()
    position, director = difference(spatial, planar)
    assert max(position, director) < 1e-11  # rounding
    moved = abs(planar.position - build_scene(flat()).initial.position).max()
    assert moved > 0.05


def test_the_fastest_rate_is_that_with_the_wall_on():
    """Against the eigenvalues of the whole Jacobian; close to a wall it is another one."""
    lying = {"kind": "straight", "points": 15, "spacing": 0.09, "origin": [0, 0.2, 0.7 * EPS],
             "rotate": {"axis": [1, 0, 0], "degrees": -90}}  # fmt: skip
    rates = {}
    for wall in ({"z": 0.0}, None):
        system = RodSystem(build_scene(flat(fluid__wall=wall, rods__rod__shape=lying)))
        rates[wall is None] = stability(system).rate
        assert rates[wall is None] == pytest.approx(largest_eigenvalue(system), rel=5e-3)
    assert abs(rates[True] / rates[False] - 1.0) > 0.01


def test_a_first_step_through_the_wall_is_rejected_and_the_run_goes_on():
    """A heavy soft rod and a wrong first size: a stage comes to the wall, so the error is NaN."""
    case = changed(
        rods__rod__loads={"weight": {"along": "all", "force": [0, 0, -1e3]}},
        rods__rod__moduli={"bending": 0.036, "twisting": 0.029, "shear": 2.1, "stretch": 1.7},
        rods__rod__shape__rotate={"axis": [0, 1, 0], "degrees": 88},
        time={"end": 0.4, "tolerance": 1e-5},
    )
    steps, system, integrator = states(case)
    start = system.scene.initial
    rate = system.rate(0.0, start, system.zeros(), system.zeros())
    integrator.fastest_rate = stability(system).rate
    assert np.isnan(integrator.attempt(start, rate, 0.4).error)
    integrator._size = 0.4
    ends = [step.end for step in steps]
    assert integrator.rejected >= 1
    assert min(state.position[2].min() for state in ends) > 0.0
    position, director = difference(ends[-1], end(case))
    assert max(position, director) < 1e-2  # two runs at 1e-5, in a fall that amplifies


def test_the_mirror_gap_is_twice_the_lowest_height():
    scene = build_scene(changed(fluid__wall={"z": -0.3}))
    gap, rod, k = mirror_gap(scene, scene.initial.position)
    z = scene.initial.position[2]
    assert gap == pytest.approx(2 * (z.min() + 0.3), rel=1e-14)
    assert (rod, k) == ("rod", int(z.argmin()))


@pytest.mark.parametrize(("height", "expected", "warned"), [(0.1, 0.2, True), (0.5, 0.45, False)])
def test_the_gap_counts_a_rod_and_its_image(height, expected, warned):
    """Lying at 0.1 the image is nearest, at 0.2 and nearer than 1.213 epsilon = 0.279; at 0.5 the
    points that are nearest and no neighbours are five spacings of 0.09 apart."""
    scene = build_scene(
        changed(
            rods__rod__shape__rotate={"axis": [0, 1, 0], "degrees": 90},
            rods__rod__shape__origin=[0.2, -0.3, height],
        )
    )
    gap = Gap(scene, {"length": "um", "time": "s"})
    gap.notify = (said := []).append
    assert gap.measure(scene.initial)["gap"] == pytest.approx(expected, rel=1e-12)
    assert [("comes closer to the wall" in text) for text in said] == [True] * warned


REFUSED = [
    (["gamma*z + 1", 0, 0], "is 1 on the wall, z = 0, at t = 0: must vanish"),
    (["2.5", 0, 0], "must vanish"),
    (["gamma*z", 0, "1e-3*x"], "must vanish"),
    (["gamma*z + where(t > 3, 0.7, 0)", 0, 0], "is 0.7 on the wall"),
    (["gamma*(z - 0.02)", 0, 0], "must vanish"),
]


@pytest.mark.parametrize(("flow", "words"), REFUSED)
def test_a_background_flow_through_or_along_the_wall_is_refused(flow, words):
    with pytest.raises(CaseError) as caught:
        build_scene(changed(parameters={"gamma": 1.9}, fluid__flow=flow))
    (problem,) = caught.value.problems
    assert problem.key == "fluid.flow"
    assert words in problem.reason


@pytest.mark.parametrize("flow", [["gamma*z", "-0.4*z", 0], ["z*(3 - z)*sin(5*t)", 0, 0]])
def test_a_background_flow_that_vanishes_on_the_wall_is_taken(flow):
    build_scene(changed(parameters={"gamma": 1.9}, fluid__flow=flow))
