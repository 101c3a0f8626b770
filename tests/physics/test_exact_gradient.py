"""N*: loads that are the gradient of the energy (6), against differences of it."""

import numpy as np
import pytest
from at_rest import case_of, near_state

from rodsim.case import case_from_mapping
from rodsim.rest.forces import Forces, moved
from rodsim.scene.build import build_scene

MODULI = {
    "uniform": {"bending": [3.1e-3, 4.7e-3], "twisting": 2.3e-3, "shear": [0.83, 0.71],
                "stretch": 1.3},
    "varying": {"bending": ["3.1e-3*(1+0.3*s)", 4.7e-3], "twisting": 2.3e-3,
                "shear": [0.83, "0.71+0.1*sin(s)"], "stretch": 1.3},
}  # fmt: skip
SHAPES = {
    "open": {"kind": "helix", "radius": 0.7, "pitch": 1.9, "points": 9, "length": 4.1},
    "closed": {"kind": "ring", "radius": 0.8, "points": 9, "twist_perturbation": 0.7},
}


def forces_of(shape, moduli, exact=True, noise=0.15):
    """Return the forces of a coarse rod far from rest, and its state."""
    data = case_of(SHAPES[shape], MODULI[moduli], [1.3, -0.4, "0.6 + 0.2*s"])
    scene = build_scene(case_from_mapping(data))
    change = noise * np.random.default_rng(4).normal(size=(6, scene.rods.points))
    return Forces(scene, exact), moved(scene.initial, change)


def slope(function, step):
    """Return the derivative at 0, from central differences of order 6."""
    ends = ((1, 45.0), (2, -9.0), (3, 1.0))
    total = sum(w * (function(n * step) - function(-n * step)) for n, w in ends)
    return total / (60.0 * step)


def mismatch(forces, state):
    """Return |L.d + dE/dd| over |L.d| along random motions of all points and triads."""
    loads, worst = forces.loads(state), 0.0
    for seed in range(5):
        along = np.random.default_rng(seed).normal(size=loads.shape)
        down = (loads * along).sum()
        up = slope(lambda h, d=along: forces.energy(moved(state, h * d)), 2e-3)
        worst = max(worst, abs(up + down) / abs(loads * along).max())
    return worst


@pytest.mark.parametrize("moduli", MODULI)
@pytest.mark.parametrize("shape", SHAPES)
def test_the_exact_loads_are_the_gradient_of_the_energy(shape, moduli):
    """Differences of order 6 at 2e-3 leave rounding, 1e-16/2e-3 of the energy: below 1e-11."""
    assert mismatch(*forces_of(shape, moduli)) < 1e-11


def test_those_of_the_paper_are_not_quite():
    """They differ by phi^2/8 of N and phi/8 of T, phi up to 1 rad from triad to triad here."""
    assert 1e-3 < mismatch(*forces_of("open", "uniform", exact=False)) < 0.3


@pytest.mark.parametrize("moduli", MODULI)
@pytest.mark.parametrize("shape", SHAPES)
def test_net_force_and_torque_of_the_exact_loads_are_zero(shape, moduli):
    forces, state = forces_of(shape, moduli)
    loads = forces.loads(state)
    torque = np.cross(state.position, loads[:3], axis=0) + loads[3:]
    assert abs(loads[:3].sum(axis=1)).max() < 1e-13 * abs(loads).max() * loads.shape[1]
    assert abs(torque.sum(axis=1)).max() < 1e-13 * abs(loads).max() * loads.shape[1]


@pytest.mark.parametrize("points", [3, 4, 5, 7, 8, 9])
@pytest.mark.parametrize("kind", ["straight", "ring"])
def test_the_stiffness_is_the_derivative_of_the_loads(kind, points):
    """Whatever the number of points leaves over when every third is displaced together."""
    size = {"length": 3.1} if kind == "straight" else {"radius": 1.7}
    shape = {"kind": kind, "points": points, **size}
    data = case_of(shape, MODULI["uniform"], [0.3, 0.2, 0.1])
    scene = build_scene(case_from_mapping(data))
    noise = 0.05 * np.random.default_rng(3).normal(size=(6, points))
    forces, state = Forces(scene), moved(scene.initial, noise)
    stiffness = forces.stiffness(state).toarray()
    for number in range(6 * points):
        along = np.zeros(6 * points)
        along[number] = 1.0
        along = along.reshape(6, points)
        found = slope(lambda h, d=along: forces.loads(moved(state, h * d)).ravel(), 4e-3)
        assert abs(found + stiffness[:, number]).max() < 1e-10 * abs(stiffness).max()


def test_the_stiffness_is_symmetric_at_rest_and_that_of_the_paper_is_not():
    shape = {"kind": "ring", "radius": 2.5, "points": 40}
    data = case_of(shape, MODULI["uniform"], [0.4, 0, 0.9])
    scene = build_scene(case_from_mapping(data))
    state = near_state(scene)
    uneven = []
    for exact in (True, False):
        matrix = Forces(scene, exact).stiffness(state)
        uneven.append(abs(matrix - matrix.T).max() / abs(matrix).max())
    assert uneven[0] < 1e-3 * uneven[1]
