"""A fast subset of benchmarks/stability.py: how stiff and extreme scenes end, and scaled scenes."""

import sys
from math import inf

import numpy as np
import pytest
from scenes import ROOT

from rodsim.case import case_from_mapping
from rodsim.convergence.outcome import solve

sys.path.insert(0, str(ROOT / "benchmarks"))
from extremes import ROD, SCENES, TAIL, changed, rescaled
from stability import measure

FINISHED = [
    ("moduli, all", "x 1e-3"),
    ("moduli, all", "x 1e2"),
    ("shear and stretch", "x 1e2"),
    ("bending and twisting", "x 1e3"),
    ("a/a3", "0.1"),
    ("epsilon, spacings", "0.5"),
    ("epsilon, spacings", "40"),
    ("points at fixed length", "3"),
    ("viscosity", "1e-09"),
    ("viscosity", "1000"),
    ("units", "metres"),
    ("units", "nanometres"),
    ("rest state", "Omega ds = 1.992, curvature"),
    pytest.param("waves", "sigma = 6.28e4 rad/s", marks=pytest.mark.long),
    ("waves", "tolerance 0.5"),
    ("starts", "stretched by 2"),
    ("starts", "compressed by half"),
    ("starts", "one triad turned by 179 degrees"),
    ("neighbours", "two rods 0.1 epsilon apart"),
    ("neighbours", "on one line"),
    ("at a wall", "0.66 epsilon above"),
    ("at a wall", "0.1 epsilon above"),
    ("at a wall", "falling on it, 1000 of its own bending forces"),
    ("contact", "across each other, pressed with 10 a/d^2"),
    ("contact", "starting 0.7 diameters apart"),
    pytest.param("contact", "plectoneme, epsilon = ds", marks=pytest.mark.long),
    pytest.param("contact", "trefoil, tight, d = L/18", marks=pytest.mark.long),
    ("held", "clamped at both ends"),
    ("held", "hook, 100 times a segment"),
    pytest.param("held", "two bodies 0.05 radii apart", marks=pytest.mark.long),
    ("long", "rod, 100 times the time"),
]


@pytest.mark.compiled
@pytest.mark.parametrize(("group", "scene"), FINISHED)
def test_finishes_near_its_reference(group, scene):
    """The end within 10 tolerances of the scene, over the length: 0.4 seen at most, and 8 where
    the motion amplifies errors or the tolerance is 0.5.
    """
    case = SCENES[group][scene]
    cells = measure(case, ("rkc", "euler", "rk4"), most=400, patience=inf)
    assert {cell.status for name, cell in cells.items() if name != "rate"} == {"finished"}
    assert cells["rkc"].error < 10 * min(1e-4, case["time"]["tolerance"])


@pytest.mark.compiled
@pytest.mark.parametrize(
    ("group", "scene", "status", "why"),
    [
        ("rest state", "Omega ds = 2.001", "refused", "abs(Omega) ds = 2.001"),
        ("starts", "a triad turned by 180 degrees", "refused", "points 19 and 20 are a half-turn"),
        ("contact", "starting 0.4 diameters apart", "refused", "cannot start inside each other"),
        ("contact", "across each other, pressed with 60 a/d^2", "stopped", "has grown to"),
        ("starts", "all triads turned by 179 degrees", "stopped", "fastest rate has grown to"),
    ],
)
def test_ends_by_name(group, scene, status, why):
    cell = measure(SCENES[group][scene], ("euler",), most=400, patience=inf)["euler"]
    assert cell.status == status
    assert why in cell.why


def end_of(case):
    return solve(case_from_mapping(case)).end


SCALES = [(2.0**20, 2.0**-30, 2.0**10), (2.0**-20, 2.0**7, 2.0**-11), (2.0**4, 2.0**40, 2.0**6)]


@pytest.mark.parametrize("scales", SCALES)
@pytest.mark.parametrize("method", ["euler", "rk4"])
def test_scaled_by_powers_of_two_is_the_same_bit_for_bit(method, scales):
    """No number in the code has a unit: length, mass and time scale out exactly."""
    points = {"rods.rod.shape.points": 9}
    step = {"integrator": method, "step": 1e-6, "end": 2e-5}
    plain = end_of(changed(ROD, {**points, "time": step}))
    length, _, time = scales
    scaled = end_of(changed(rescaled(*scales), {
        **points, "time": {**step, "step": 1e-6 * time, "end": 2e-5 * time}}))  # fmt: skip
    np.testing.assert_array_equal(scaled.position / length, plain.position)
    np.testing.assert_array_equal(scaled.director, plain.director)


@pytest.mark.parametrize("scales", [(1e-6, 1e-3, 1e-3), (1e3, 1e6, 1e6)])
def test_other_units_change_rounding_only(scales):
    """Adaptive steps too: the same steps, so 1e-12 of the length, from rounding in 1e3 terms."""
    small = {"rods.rod.shape.points": 9, "time.tolerance": 1e-5}
    plain = end_of(changed(ROD, {**small, "time.end": 1e-4}))
    scaled = end_of(changed(rescaled(*scales), {**small, "time.end": 1e-4 * scales[2]}))
    np.testing.assert_allclose(scaled.position / scales[0], plain.position, rtol=0, atol=6e-11)


def test_a_step_follows_the_drive_at_any_tolerance():
    """At a tolerance of 0.9 accuracy asks for nothing: without a guard steps span whole periods."""
    case = changed(TAIL, {"rods.tail.shape.points": 9, "time": {"end": 0.0785, "tolerance": 0.9}})
    periods = 0.0785 * 400 / (2 * np.pi)
    loose, tight = (
        solve(case_from_mapping(changed(case, {"time.tolerance": t}))) for t in (0.9, 1e-5)
    )
    assert loose.steps >= 4 * periods  # at most 1.44 rad a step, docs of StrainTwist.travel
    gap = abs(loose.end.position - tight.end.position).max()
    moved = abs(tight.end.position - tight.scene.initial.position).max()
    assert gap < 0.5 * moved
