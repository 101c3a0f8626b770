"""Rods in a background flow: exact motions, Jeffery's orbit, buckling."""

import numpy as np
import pytest
from acting import ROD, changed
from scenes import end_of, system_from

from rodsim.analysis.replay import Sources
from rodsim.compiled.row import TRAVEL_TIMES
from rodsim.scene.evaluation import Exerted
from rodsim.scene.shapes import rotation_matrix


@pytest.mark.compiled
def test_in_a_uniform_flow_the_motion_is_the_free_one_and_the_flow():
    """The equations do not see where they are; the last steps round differently."""
    free, _ = end_of(ROD)
    carried, _ = end_of(changed(ROD, {"fluid.flow": [0.7, -0.4, 1.3]}))
    drift = 0.6 * np.array([[0.7], [-0.4], [1.3]])
    assert carried.position == pytest.approx(free.position + drift, abs=1e-8)
    assert carried.director == pytest.approx(free.director, abs=1e-8)
    assert abs(free.position - ROD["rods"]["rod"]["shape"]["origin"][0]).max() > 0.2


@pytest.mark.compiled
def test_in_a_rigid_rotation_the_motion_is_the_free_one_turned():
    """Frame indifference: u_inf = Omega x x, w_inf = Omega and elasticity at once."""
    omega = np.array([0.6, -1.1, 1.7])
    a, b, c = omega
    flow = [f"{b}*z - {c}*y", f"{c}*x - {a}*z", f"{a}*y - {b}*x"]
    tight = changed(ROD, {"time.tolerance": 1e-12})  # at 1e-10 4e-8 off
    free, _ = end_of(tight)
    carried, _ = end_of(changed(tight, {"fluid.flow": flow}))
    turn = rotation_matrix(omega, np.linalg.norm(omega) * 0.6)
    assert carried.position == pytest.approx(turn @ free.position, abs=1e-8)
    turned = np.einsum("ab,ibk->iak", turn, free.director)
    assert carried.director == pytest.approx(turned, abs=1e-8)


def straight(length, epsilon, points, **changes):
    """A straight, relaxed rod along z in the plane x = 0, its middle at 0."""
    rod = {
        "shape": {"kind": "straight", "points": points, "length": length,
                  "origin": [0, 0, -length / 2]},
        "moduli": {"bending": 0.7, "twisting": 0.7, "shear": 1.3, "stretch": 1.3},
    }  # fmt: skip
    case = {"fluid": {"viscosity": 1.7, "epsilon": epsilon}, "rods": {"rod": rod},
            "time": {"end": 0.5, "tolerance": 1e-6}}  # fmt: skip
    return changed(case, changes)


def moduli(bending, strain):
    return {"bending": bending, "twisting": bending, "shear": strain, "stretch": strain}


@pytest.mark.compiled
def test_a_rod_along_the_vorticity_axis_spins_at_half_the_shear_rate():
    """u_x = gamma y, the rod along z: w = -gamma/2 about its own axis, and it stays."""
    gamma, end = 0.9, 0.5
    state, system = end_of(straight(2.3, 0.21, 15, **{"fluid.flow": [f"{gamma}*y", 0, 0]}))
    angle = np.arctan2(state.director[0, 1], state.director[0, 0])
    assert angle == pytest.approx(-0.5 * gamma * end, rel=1e-6)
    assert state.position == pytest.approx(system.scene.initial.position, abs=1e-9)


@pytest.mark.compiled
def test_jeffery_period_of_a_stiff_rod():
    """gamma T = 37.3045 at L/eps = 10, ds = eps/2, from the rigid rod's 6N mobility (r_e = 5.7637).

    8 pi mu gamma L^4/B = 40, b = 600 B/L^2, start along the gradient; so is its second half turn.
    """
    length, gamma = 2.3, 0.9
    bending = 8 * np.pi * 1.7 * gamma * length**4 / 40
    end = 37.3045 / gamma
    case = straight(
        length, length / 10, 21,
        **{"rods.rod.moduli": moduli(bending, 600 * bending / length**2), "plane": "yz",
           "fluid.flow": [0, f"{gamma}*z", 0], "time.end": end},
    )  # fmt: skip
    state, _ = end_of(case)
    y, z = (state.position[i, -1] - state.position[i, 0] for i in (1, 2))
    rate = gamma * 5.7637**2 / (5.7637**2 + 1)  # along the gradient
    period = end - np.arctan2(y, z) / rate
    assert z > 0
    assert gamma * period == pytest.approx(37.3045, rel=1e-4)


def compressed(eta, slenderness, spacing, strain, rate=0.6):
    """A system with a rod in u = rate (0, y, -z), pressed until it shortens no more; its state."""
    length, points = 2.3, round(slenderness / spacing) + 1
    bending = 8 * np.pi * 1.7 * rate * length**4 / eta
    case = straight(
        length, length / slenderness, points,
        **{"rods.rod.moduli": moduli(bending, strain * bending / length**2), "plane": "yz",
           "fluid.flow": [0, f"{rate}*y", f"-{rate}*z"],
           "time.end": 0.03 / rate, "time.tolerance": 1e-9},
    )  # fmt: skip
    state, system = end_of(case)
    still = system.velocities(0.0, state, system.zeros(), system.zeros())[: system.rod_size]
    assert abs(still).max() < 1e-6 * rate * length  # at rest
    return system, state


def growth(eta, slenderness, spacing, strain, rate=0.6):
    """Return sigma/rate of the even bending mode: the largest but that of a drift along y."""
    system, state = compressed(eta, slenderness, spacing, strain, rate)
    n = system.scene.rods.points
    free = np.r_[n : 3 * n, 3 * n : 4 * n]  # y, z, and the angle about x
    jacobian, small = np.empty((3 * n, 3 * n)), 1e-6
    for column, index in enumerate(free):
        rates = []
        for sign in (1.0, -1.0):
            y = system.zeros()
            y[index] = sign * small
            rates.append(system.rate(0.0, state, y, system.zeros())[free])
        jacobian[:, column] = (rates[0] - rates[1]) / (2 * small)
    values, vectors = np.linalg.eig(jacobian)
    lateral = vectors[:n].real / np.linalg.norm(vectors, axis=0)
    size, odd, bent = (
        np.linalg.norm(part, axis=0)
        for part in (lateral, lateral - lateral[::-1], lateral - lateral.mean(axis=0))
    )
    even = (size > 1e-3) & (odd < 1e-3 * size)
    drift = even & (bent < 1e-3 * size)
    assert values[drift].real / rate == pytest.approx([1.0], rel=1e-3)
    return values[even & ~drift].real.max() / rate


def threshold(low, high, *of):
    """Return eta at which the mode is marginal, by a line in log eta through two near it."""
    below, above = (growth(eta, *of) for eta in (low, high))
    assert below < 0 < above
    return low * (high / low) ** (-below / (above - below))


@pytest.mark.compiled
def test_buckling_threshold_of_a_rod_of_30_epsilon():
    """586.2, a separate program, from the Jacobian of the whole scheme; 153 c of slender-body
    theory would be 1042."""
    assert threshold(570.0, 605.0, 30, 0.5, 1.6e5) == pytest.approx(586.2, rel=0.01)


@pytest.mark.compiled
def test_buckling_threshold_of_a_rod_of_60_epsilon():
    assert threshold(795.0, 840.0, 60, 0.75, 1.6e5) == pytest.approx(816.0, rel=0.01)


@pytest.mark.compiled
@pytest.mark.parametrize(("eta", "rate"), [(900.0, 1.1203), (1150.0, 1.5746)])
def test_growth_rate_of_a_buckling_rod(eta, rate):
    """L/eps 30, ds = eps/2, b = 4e4 B/L^2: the same separate program; 2 %."""
    assert growth(eta, 30, 0.5, 4e4) == pytest.approx(rate, rel=0.02)


@pytest.mark.compiled
@pytest.mark.parametrize(("sign", "bends"), [(-1, True), (1, False)])
def test_a_shear_bends_a_rod_in_its_compressing_quadrant_only(sign, bends):
    """At 45 degrees the rate along the rod is sign gamma/2; the tiny bend it starts with grows or
    is pulled straight. eta = 8 pi mu (gamma/2) L^4/B = 1800, three times the threshold."""
    length, gamma, points = 2.3, 1.2, 31
    bending = 8 * np.pi * 1.7 * 0.5 * gamma * length**4 / 1800
    bent = {"kind": "sine", "amplitude": 1e-4 * length, "wavelength": 2 * length, "points": points,
            "length": length, "rotate": {"axis": [1, 0, 0], "degrees": -45}}  # fmt: skip
    case = straight(
        length, length / 30, points,
        **{"rods.rod.moduli": moduli(bending, 4e4 * bending / length**2), "plane": "yz",
           "fluid.flow": [0, f"{sign * gamma}*z", 0], "time.end": 0.9 / gamma},
    )  # fmt: skip
    state, system = end_of(changed(case, {"rods.rod.shape": bent}))

    def bend(position):
        """The middle from the line through the ends: the even part, an S-shape has none."""
        first, middle, end = position[1:, [0, points // 2, -1]].T
        chord = (end - first) / np.linalg.norm(end - first)
        return (middle - 0.5 * (first + end)) @ [chord[1], -chord[0]]

    gained = bend(state.position) / bend(system.scene.initial.position)
    assert gained > 1.4 if bends else abs(gained) < 0.7


def test_the_fluid_far_from_a_rod_is_the_background():
    """Velocity at any point: that of the rods, and exactly u_inf; the pressure of plates too."""
    flow = ["4*1.3*z*(3.7 - z)/3.7**2", 0.4, 0]
    _, plain = system_from(ROD)
    _, system = system_from(changed(ROD, {"fluid.flow": flow}))
    state, points = system.scene.initial, np.random.default_rng(3).normal(size=(40, 3))
    loads = np.random.default_rng(4).normal(size=(6, 12))
    with_flow, without = (
        Sources(0.0, state.position, Exerted(loads), s.scene) for s in (system, plain)
    )
    z = points[:, 2]
    background = np.array([4 * 1.3 * z * (3.7 - z) / 3.7**2, 0 * z + 0.4, 0 * z]).T
    assert with_flow.velocity(points) - without.velocity(points) == pytest.approx(background)
    gained = with_flow.pressure(points) - without.pressure(points)
    assert gained == pytest.approx(-8 * 1.3 * 1.3 / 3.7**2 * points[:, 0])  # dp/dx = -8 mu U/H^2


@pytest.mark.parametrize(
    ("flow", "slope"),
    [
        ([0, 0, "1.7*(1 - (x**2 + y**2)/0.8**2)"], [0, 0, -4 * 1.3 * 1.7 / 0.8**2]),
        (["0.3*y - z", 0.7, "x*cos(2.1)"], [0, 0, 0]),
        (["t*y**2", 0, 0], [0.6 * 1.3 * 2, 0, 0]),
    ],
)
def test_pressure_of_a_flow_whose_laplacian_is_the_same_everywhere(flow, slope):
    _, system = system_from(changed(ROD, {"fluid.flow": flow}))
    (part,) = (p for p in system.scene.parts if p.name == "flow" and p.side == "tracers")
    points = np.random.default_rng(3).normal(size=(3, 20))
    found = part.pressure(points, None, None, 0.6, None)
    assert found == pytest.approx(slope @ points, rel=1e-12, abs=1e-14)


def test_another_flow_has_no_pressure():
    _, system = system_from(changed(ROD, {"fluid.flow": ["sin(z)", 0, 0]}))
    (part,) = (p for p in system.scene.parts if p.name == "flow" and p.side == "tracers")
    assert part.pressure is None


def test_a_flow_that_changes_in_time_says_how_fast():
    """``travel`` of the flow, as of any drive; a steady one is not driven."""
    _, steady = system_from(changed(ROD, {"fluid.flow": ["2.3*z", 0, 0]}))
    _, driven = system_from(changed(ROD, {"fluid.flow": ["2.3*z*cos(40*t)", 0, 0]}))
    assert not steady.scene.parts.driven
    wave = np.cos(40 * (0.3 + 0.01 * TRAVEL_TIMES))  # whatever the place
    gaps = abs(np.diff(wave))
    expected = (gaps.sum() - gaps.max()) / abs(wave).max()
    assert driven.scene.parts.travel(0.3, 0.01) == pytest.approx(expected, rel=1e-9)
