"""Tethers at bodies: force and torque at a place that turns along, energy, and balance."""

import numpy as np
import pytest
from scenes import end_of, system_from

MODULI = {"bending": 3.1e-3, "twisting": 2.7e-3, "shear": 0.7, "stretch": 0.9}
P, ORIGIN, ANCHOR = np.array([0.3, 0.0, 0.6]), np.array([0.4, -0.2, 1.1]), [1.3, 0.5, 2.2]
AXIS, DEGREES = [1.0, 2.0, -0.5], 50.0


def data(**tether):
    shape = {"kind": "spheroid", "length": 1.6, "radius": 0.5, "points": 20}
    shape |= {"rotate": {"axis": AXIS, "degrees": DEGREES}, "origin": ORIGIN.tolist()}
    rod = {"kind": "straight", "points": 5, "spacing": 0.2, "origin": [4.0, 0.0, 0.0]}
    link = {"from": {"body": "cell", "at": P.tolist()}, "to": ANCHOR, "stiffness": 2.3e-3}
    return {
        "fluid": {"viscosity": 1.3e-6, "epsilon": 0.2},
        "bodies": {"cell": {"shape": shape}},
        "rods": {"far": {"shape": rod, "moduli": MODULI}},
        "tethers": {"link": link | {"length": 0.4} | tether},
        "time": {"end": 6e-3, "tolerance": 1e-5},
    }


def turn():
    """Return the rotation matrix of the body, by Rodrigues' formula."""
    n = np.array(AXIS) / np.linalg.norm(AXIS)
    K = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    a = np.radians(DEGREES)
    return np.eye(3) + np.sin(a) * K + (1.0 - np.cos(a)) * K @ K


def test_a_tether_pulls_and_turns_a_body_at_its_place():
    """The body moves as its resistance says under F and R p x F; the rod is far away."""
    _, system = system_from(data())
    state, body = system.scene.initial, system.scene.bodies[0]
    _, seen = system.observe(state)
    d = np.array(ANCHOR) - ORIGIN - turn() @ P
    force = 2.3e-3 * (np.linalg.norm(d) - 0.4) * d / np.linalg.norm(d)
    wrench = np.concatenate([turn().T @ force, np.cross(P, turn().T @ force)])
    motion = np.linalg.solve(body.resistance, wrench)
    assert seen["body_velocity"][0] == pytest.approx(turn() @ motion[:3], rel=1e-6)
    assert seen["body_angular_velocity"][0] == pytest.approx(turn() @ motion[3:], rel=1e-6)
    assert seen["net_force"] == pytest.approx(force, rel=1e-9)
    arm = ORIGIN + turn() @ P
    assert seen["net_torque"] == pytest.approx(np.cross(arm, force), rel=1e-9)
    energy = 0.5 * 2.3e-3 * (np.linalg.norm(d) - 0.4) ** 2
    assert seen["tether_energy"] == pytest.approx([energy], rel=1e-12)


def test_its_energy_ends_in_the_fluid():
    state, system = end_of(data())
    _, start = system.observe(system.scene.initial)
    _, end = system.observe(state)
    lost = start["tether_energy"][0] - end["tether_energy"][0]
    assert lost > 0.5 * start["tether_energy"][0]
    assert lost == pytest.approx(end["dissipated"], rel=1e-3)  # the tolerance of the run, 1e-5


def test_a_body_tethered_to_a_rod_leaves_no_net_force():
    _, system = system_from(data(to={"rod": "far", "s": 0.5}))
    _, seen = system.observe(system.scene.initial)
    assert seen["tether_energy"][0] > 1e-3
    for name in ("net_force", "net_torque"):
        assert seen[name] == pytest.approx([0, 0, 0], abs=1e-15)


def test_a_body_that_is_not_there_is_named():
    from rodsim.errors import CaseError

    wrong = data() | {"tethers": {"link": {"from": {"body": "cel"}, "to": ANCHOR, "stiffness": 2}}}
    with pytest.raises(CaseError, match="no such body: did you mean 'cell'"):
        system_from(wrong)
