"""Rods under their weight and pulled at places: exact speeds, shapes, balances."""

import numpy as np
import pytest
from acting import ROD, changed, weighted_mean
from scenes import end_of, system_from

LENGTH, VISCOSITY, FORCE = 2.3, 1.7, 0.8  # of the sedimenting rods, per length


def sinking(slenderness, points, force, bending=0.7, strain=1.3, **changes):
    """A straight rod along y, its weight a force per length."""
    rod = {
        "shape": {"kind": "straight", "points": points, "length": LENGTH,
                  "rotate": {"axis": [1, 0, 0], "degrees": -90}},
        "moduli": {"bending": bending, "twisting": bending, "shear": strain, "stretch": strain},
        "loads": {"weight": {"along": "all", "force": force}},
    }  # fmt: skip
    case = {"fluid": {"viscosity": VISCOSITY, "epsilon": LENGTH / slenderness},
            "rods": {"rod": rod}, "time": {"end": 0.5, "tolerance": 1e-5}}  # fmt: skip
    return changed(case, changes)


@pytest.mark.parametrize(("slenderness", "points"), [(20, 41), (50, 101)])
def test_speed_of_a_straight_rod_across_and_along(slenderness, points):
    """Its mean is f asinh(L/eps)/(4 pi mu) across, f [asinh - sqrt(1 + e^2) + e]/(2 pi mu) along,
    e = eps/L: the mean over the rod of the velocity of a uniform line of blobs; ds = eps/2."""
    e, a = 1 / slenderness, np.arcsinh(slenderness)
    across = FORCE * a / (4 * np.pi * VISCOSITY)
    along = FORCE * (a - np.sqrt(1 + e * e) + e) / (2 * np.pi * VISCOSITY)
    for force, axis, speed in (([0, 0, -FORCE], 2, -across), ([0, FORCE, 0], 1, along)):
        _, system = system_from(sinking(slenderness, points, force))
        fields, _ = system.observe(system.scene.initial)
        assert weighted_mean(system, fields["velocity"])[axis] == pytest.approx(speed, rel=1.5e-3)


def settled(b_g):
    """Return A/L, end-to-end/L and speed of a rod that has come to its shape; N 31, L/eps 30."""
    weight = FORCE * LENGTH
    bending = weight * LENGTH**2 / b_g
    state, system = end_of(
        sinking(30, 31, [0, 0, -FORCE], bending, 60 * weight, plane="yz",
                **{"time.end": 1.6 * 8 * np.pi * VISCOSITY / FORCE * LENGTH})
    )  # fmt: skip
    fields, _ = system.observe(state)
    x = state.position
    amplitude = x[2, [0, -1]].mean() - x[2, 15]
    speed = -fields["velocity"][2].mean()
    straight = FORCE * np.arcsinh(30.0) / (4 * np.pi * VISCOSITY)
    return amplitude / LENGTH, np.linalg.norm(x[:, -1] - x[:, 0]) / LENGTH, speed / straight


TABLE = {  # B_g = f L^3/B, b = 60 W: runs of a separate program to the steady shape
    10: (0.01752, 0.99918, 0.95469),
    50: (0.08810, 0.98034, 0.96589),
    200: (0.33542, 0.65621, 1.15960),
    3000: (0.43442, 0.18955, 1.43123),
}


@pytest.mark.compiled
@pytest.mark.parametrize("b_g", TABLE)
def test_shape_and_speed_of_a_rod_that_sinks_across(b_g):
    assert settled(b_g) == pytest.approx(TABLE[b_g], rel=0.01)


def test_net_force_and_torque_are_those_from_outside():
    """Elastic loads add up to nothing; the follower's are those of the triad there."""
    loads = {
        "weight": {"along": "all", "force": [0.3, -0.2, 0.7], "torque": ["0.1*s", 0, 0.4]},
        "tip": {"at": "end", "force": [0, 0.3, -0.9], "torque": [0.2, 0, 0], "frame": "triad"},
    }
    link = {"from": {"rod": "rod", "s": 0.4}, "to": [0.3, 0.9, 1.1], "stiffness": 2.3}
    state, system = end_of(
        changed(ROD, {"rods.rod.loads": loads, "tethers": {"link": link}, "time.end": 0.1})
    )
    _, seen = system.observe(state)
    assert seen["net_force"] == pytest.approx(seen["external_force"], abs=1e-12)
    assert seen["net_torque"] == pytest.approx(seen["external_torque"], abs=1e-12)
    length, tip = 11 * 0.13, state.director[:, :, -1].T
    k = state.position[:, 3] + (0.4 / 0.13 - 3) * (state.position[:, 4] - state.position[:, 3])
    pull = 2.3 * (np.array([0.3, 0.9, 1.1]) - k)
    expected = np.array([0.3, -0.2, 0.7]) * length + tip @ [0, 0.3, -0.9] + pull
    assert seen["external_force"] == pytest.approx(expected, rel=1e-12)


def test_the_smallest_follower_turns_with_its_point():
    """In a rigid rotation of the whole scene, follower and all, the loads turn with it."""
    loads = {"tip": {"s": 0.5, "force": [0.2, 0.3, -0.9], "torque": [0.1, 0.4, 0.3]}}
    follower = changed(ROD, {"rods.rod.loads": loads, "rods.rod.loads.tip.frame": "triad"})
    turned = changed(follower, {"rods.rod.shape.rotate": {"axis": [-0.7, 0.2, 1.3], "degrees": 77}})
    rates = []
    for case in (follower, turned):
        _, system = system_from(case)
        fields, _ = system.observe(system.scene.initial)
        triad = system.scene.initial.director[:, :, 0]
        rates.append(triad @ fields["velocity"])
    assert rates[1] == pytest.approx(rates[0], rel=1e-9)
