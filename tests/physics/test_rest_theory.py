"""When rods buckle, and how fast they move: against theory and the digits of another program.

Thresholds are where an eigenvalue of the exact stiffness is 0. The error of a spacing is c ds^2, so
two numbers of points are extrapolated; what is left is c' ds^4, below 1e-5 here.
"""

from dataclasses import replace

import numpy as np
import pytest
from at_rest import (
    R0,
    A,
    case_of,
    ends,
    extrapolated,
    held,
    modes,
    moduli_of,
    near_state,
    ring,
    threshold,
)

from rodsim.case import case_from_mapping
from rodsim.rest.forces import Forces, moved
from rodsim.rest.rates import main_rates, mobility, rates_of, shares_of
from rodsim.scene.build import build_scene

pytestmark = pytest.mark.compiled  # interpreted they take hours


def michell(points, b=0.8, waves=(1.70, 1.80)):
    return threshold(lambda u: ring(points, [0, 0, u / R0], b), *waves)


@pytest.mark.parametrize(("u", "growing"), [(1.72, 0), (1.7337, 2), (2.5, 2), (2.85, 4)])
def test_modes_of_michells_ring(u, growing):
    """Pairs, as the circle has no place to begin; neutral: six rigid motions and the register."""
    found = modes(ring(60, [0, 0, u / R0]))
    assert (found.growing, found.neutral) == (growing, 7)


def test_michells_ring_buckles_at_the_twist_of_theory():
    """sqrt(3) (1 - a/(b r0^2)): Michell 1889, with the shear that makes the circle smaller."""
    found = michell(40), michell(80)
    assert found == pytest.approx((1.732634, 1.731287), rel=1e-6)  # another program
    theory = np.sqrt(3.0) * (1.0 - A / (0.8 * R0**2))
    assert extrapolated(*found) == pytest.approx(theory, rel=1e-7)


@pytest.mark.long
def test_michells_ring_of_stiff_shear():
    assert michell(80, b=80.0) == pytest.approx(1.732484, rel=1e-5)


def curved(points, gamma, rho, low, high, b=0.8):
    """Return u = Omega_1 r0 at which a ring of natural curvature u/r0 buckles."""
    moduli = b, [A, A * rho], A * gamma
    return threshold(lambda u: ring(points, [u / R0, 0, 0], *moduli), low, high)


@pytest.mark.parametrize(("u", "growing"), [(-0.02, 1), (0.02, 0), (1.9, 0), (2.1, 2)])
def test_modes_of_a_ring_of_natural_curvature(u, growing):
    """Turned inside out below u = 0, buckled above 2 (Manning & Hoffman 2001)."""
    found = modes(ring(40, [u / R0, 0, 0]))
    assert (found.growing, found.neutral) == (growing, 6)


@pytest.mark.parametrize(
    ("gamma", "rho", "theory", "coarse", "fine"),
    [
        (1.0, 1.0, 2.0, 2.010397, 2.002577),
        pytest.param(2 / 3, 1.0, 1.808143, None, 1.810190, marks=pytest.mark.long),
        pytest.param(1.5, 1.0, 2.212214, None, 2.215412, marks=pytest.mark.long),
        pytest.param(1.0, 1.5, 2.212214, None, 2.215412, marks=pytest.mark.long),
        pytest.param(0.8, 2.0, 2.2, None, 2.203239, marks=pytest.mark.long),
    ],
)
def test_an_overcurved_ring_buckles_where_theory_says(gamma, rho, theory, coarse, fine):
    """(1 + (u - 1)/gamma)(1 + (u - 1)/rho) = n^2 with n = 2."""
    assert (1 + (theory - 1) / gamma) * (1 + (theory - 1) / rho) == pytest.approx(4.0, rel=1e-5)
    b = 0.8 if gamma == rho else 80.0
    found = [curved(m, gamma, rho, theory - 0.08, theory + 0.08, b) for m in (40, 80)]
    assert found[1] == pytest.approx(fine, rel=1e-5)
    assert coarse is None or found[0] == pytest.approx(coarse, rel=1e-5)
    assert extrapolated(*found) == pytest.approx(theory, rel=2e-5)  # c' ds^4


def greenhill(points, b):
    """Return m L/a at which a straight rod, held at both ends and twisted, buckles."""
    length = 10.0
    shape = {"kind": "straight", "points": points, "length": length}
    scene = build_scene(case_from_mapping(case_of(shape, moduli_of(b), [0, 0, 0])))

    def twisted(moment):
        turn = 2.0 * np.arcsin(0.5 * moment / length * scene.rods[0].spacing)
        change = np.zeros((6, points))
        change[5] = turn * np.arange(points)
        start = replace(scene, initial=moved(scene.initial, change))
        return held(start, ends(start, 0, -1))

    return threshold(twisted, 8.8, 9.1)


def test_greenhills_rod_between_clamps():
    """tan x = x with x = m L/(2 a): Greenhill 1883, and the digits of another program."""
    found = greenhill(41, 80.0), greenhill(81, 80.0)
    assert found == pytest.approx((8.969777, 8.982546), rel=1e-6)
    x = 0.5 * extrapolated(*found)
    assert np.tan(x) == pytest.approx(x, rel=1e-3)  # its slope there is 20
    assert extrapolated(*found) == pytest.approx(8.986819, rel=1e-5)  # b is not infinite
    assert greenhill(41, 0.8) == pytest.approx(8.968242, rel=1e-6)


def euler(points, load):
    """Return the modes of a rod that stands in a clamp under a dead load on its end."""
    shape = {"kind": "straight", "points": points, "length": 4.3}
    data = case_of(shape, moduli_of(80.0), [0, 0, 0])
    weight = {"at": "end", "force": [0, 0, -load * A / 4.3**2]}
    data["rods"]["rod"]["loads"] = {"weight": weight}
    scene = build_scene(case_from_mapping(data))
    return modes(held(scene, ends(scene, 0)))


def test_eulers_column_under_a_dead_load():
    """It falls over, in any direction, above P L^2/a = pi^2/4."""
    low, high = (euler(41, np.pi**2 / 4 * share) for share in (0.998, 1.002))
    assert (low.growing, low.neutral) == (0, 0)
    assert (high.growing, high.neutral) == (2, 0)


@pytest.fixture(scope="module")
def straight():
    """Rates, stiffness and arc length of a free rod whose spectrum another program knows."""
    ds = np.pi / 40
    shape = {"kind": "straight", "points": 76, "spacing": ds}
    scene = build_scene(case_from_mapping(case_of(shape, moduli_of(), [0, 0, 0], 6 * ds)))
    stiffness = Forces(scene).stiffness(scene.initial)
    rates = rates_of(stiffness, mobility(scene, scene.initial, np.arange(6 * 76)))
    return rates, stiffness, ds * np.arange(76)


def beam(s, k):
    """Return the displacement and slope of a free beam's mode with wave number k/L."""
    z, length = s / s[-1], s[-1]
    ratio = (np.cosh(k) - np.cos(k)) / (np.sinh(k) - np.sin(k))
    shape = np.cosh(k * z) + np.cos(k * z) - ratio * (np.sinh(k * z) + np.sin(k * z))
    slope = np.sinh(k * z) - np.sin(k * z) - ratio * (np.cosh(k * z) + np.cos(k * z))
    return shape, k / length * slope


@pytest.mark.parametrize(
    ("mode", "first", "second"),
    [
        (("bend", 4.730041), (-104.390, 0.67), (-116.074, 0.26)),
        (("bend", 7.853205), (-685.894, 0.71), (-592.243, 0.14)),
        (("twist", 1), (-517.838, 0.58), (-571.026, 0.35)),
        (("twist", 2), (-2057.67, 0.75), None),
        (("stretch", 1), (-36334.8, 0.65), None),
    ],
)
def test_how_a_straight_rod_relaxes(straight, mode, first, second):
    """The rates at which most of a perturbation's energy decays, 6 digits of another program."""
    rates, stiffness, s = straight
    kind, number = mode
    shape = np.zeros((6, 76))
    if kind == "bend":
        shape[0], shape[4] = beam(s, number)
    else:
        shape[{"twist": 5, "stretch": 2}[kind]] = np.cos(number * np.pi * s / s[-1])
    shares = shares_of(rates, stiffness, shape.ravel())
    assert shares.sum() == pytest.approx(1.0, abs=1e-6)
    found = main_rates(rates, shares, 2)
    for (rate, share), wanted in zip(found, (first, second), strict=True):
        if wanted:
            assert rate == pytest.approx(wanted[0], rel=1e-5)
            assert share == pytest.approx(wanted[1], abs=0.01)


def test_the_stiffness_of_twist_of_a_straight_rod():
    """A chain of torsion springs a/ds on weights eps^2: 4 a sin^2(n pi/(2 M))/(ds eps^2)."""
    shape = {"kind": "straight", "points": 30, "length": 3.7}
    moduli = moduli_of(twisting=2.1e-3)
    found = modes(build_scene(case_from_mapping(case_of(shape, moduli, [0, 0, 0]))), 14)
    expected = 4.0 * 2.1e-3 * np.sin(np.pi / 60) ** 2 / (3.7 / 29 * 0.314**2)
    assert (found.growing, found.neutral) == (0, 6)
    assert abs(found.values / expected - 1.0).min() < 1e-9


def test_the_fastest_rate_of_a_straight_rod(straight):
    rates = straight[0].values
    assert rates[-1] == pytest.approx(-272254.9642, rel=1e-8)
    assert (abs(rates[:6]) < 1e-4).all()
    assert rates[6] == pytest.approx(-0.31982, rel=1e-4)


@pytest.mark.parametrize(
    ("points", "rate"), [(40, 28.5725), pytest.param(80, 28.2667, marks=pytest.mark.long)]
)
def test_growth_of_michells_ring(points, rate):
    scene = ring(points, [0, 0, 2.0 / R0])
    state = near_state(scene)
    rates = rates_of(Forces(scene).stiffness(state), mobility(scene, state, np.arange(6 * points)))
    assert rates.values[:2].real == pytest.approx([rate, rate], rel=1e-4)
