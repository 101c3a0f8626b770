"""Held and driven rods: balances, power, what a joint holds, mirrors, and how fast they are."""

import numpy as np
import pytest
from acting import changed
from held import MOVE, PLAIN, SCENES, SWIMMER, out_of_place, turn_members
from scenes import system_from

from rodsim.forces.elastic import ENERGIES
from rodsim.integrators.limits import stability

TIME = 0.3
PUSHED = {"bodies.ball.force": [0.3, -0.2, 0.4], "bodies.ball.torque": [0.1, 0.2, -0.3]}


def placed(data):
    """Return a system and a state out of place but held."""
    case, system = system_from(data)
    state = out_of_place(system, TIME)
    turn_members(case, system, state)
    return system, system.state_at(state, TIME, system.zeros())


def nodes_of(system, state):
    """Return u and w (6, N) of all nodes."""
    out = system.velocities(state.time, state, system.zeros(), system.zeros())
    return out[: 6 * system.scene.nodes].reshape(6, -1)


@pytest.mark.parametrize("name", SCENES)
def test_what_reaches_the_fluid_is_what_acts_from_outside(name):
    """Loads of holders and on bodies, and nothing of motors, hooks and rods: to rounding."""
    scene = SCENES[name]
    if "bodies" in scene:
        scene = changed(scene, PUSHED)
    system, state = placed(scene)
    fields, seen = system.observe(state)
    force, torque = (seen.get(f"external_{what}", np.zeros(3)) for what in ("force", "torque"))
    if "anchor_force" in seen:
        report = next(part.report for part in system.scene.parts if part.report)
        held = [report.blocks[b] for b in report.held]
        places = [state.position[:, b.node if b.node >= 0 else b.members[0].node] for b in held]
        force = force + seen["anchor_force"].sum(axis=0)
        moments = np.cross(places, seen["anchor_force"]) + seen["anchor_torque"]
        torque = torque + moments.sum(axis=0)
    size = abs(fields["force"]).sum() + abs(fields["torque"]).sum()
    tolerance = 1e-12 if "two" not in name else 1e-9  # several blocks are iterated
    assert seen["net_force"] == pytest.approx(force, abs=tolerance * size)
    assert seen["net_torque"] == pytest.approx(torque, abs=tolerance * size)


def miss_of_power(points, name):
    """Return how far the powers are from balancing, over what is dissipated; rods are smooth."""
    curved = {f"rods.{rod}.shape": {"kind": "helix", "radius": 0.4, "pitch": 1.7, "length": 0.9,
                                    "points": points, "origin": [0.1, -0.2, 0.95]}
              for rod in SCENES[name]["rods"]}  # fmt: skip
    _, system = system_from(changed(SCENES[name], curved))
    start = system.scene.initial
    out = system.velocities(0.0, start, system.zeros(), system.zeros()).copy()
    gauges = {g.name: slice(0, 0) for g in system.scene.parts.gauges}
    at = system.ledger.start + len(system.scene.parts.working)
    dissipated, at = out[at], at + 1
    for gauge in system.scene.parts.gauges:
        gauges[gauge.name] = slice(at, at + gauge.count)
        at += gauge.count
    power = sum(out[gauges[f"{who}_work"]].sum() for who in ("anchor", "motor"))
    power += out[system.ledger][: len(system.scene.parts.working)].sum()

    def energy(h):
        _, seen = system.observe(system.state_at(start, h, h * out))
        return sum(seen[e].sum() for e in ENERGIES) + sum(seen.get("hook_energy", [0.0]))

    h = 1e-6
    gained = (energy(h) - energy(-h)) / (2 * h)
    return (power - dissipated - gained) / dissipated


@pytest.mark.parametrize("name", ["clamped and hinged in space", "line", "wound hook", "towed"])
def test_powers_balance_with_second_order_in_the_spacing(name):
    """P of motors and holders - dissipated - dE/dt: only the torque (31) errs, by O(ds^2)."""
    misses = np.array([miss_of_power(points, name) for points in (9, 17)])
    assert abs(misses[1]) < 5e-3
    assert np.log2(misses[0] / misses[1]) == pytest.approx(2.0, abs=0.25)


def test_the_torque_of_a_rate_motor_given_to_a_torque_motor_is_the_same_motion():
    system, state = placed(SWIMMER)
    _, seen = system.observe(state)
    motor = {"torque": float(seen["motor_torque"][0])}
    other, same = placed(changed(SWIMMER, {"rods.tail.start.motor": motor}))
    assert (same.position == state.position).all()
    first, second = nodes_of(system, state), nodes_of(other, same)
    assert second == pytest.approx(first, abs=1e-11 * abs(first).max())
    _, again = other.observe(same)
    assert again["motor_rate"] == pytest.approx(seen["motor_rate"], rel=1e-11)


@pytest.mark.parametrize("to", ["space", "ball"])
def test_a_joint_holds_twist(to):
    """A straight rod that wants to be twisted stays, its ends bear the moment; a motor that does
    not turn with its torque lets it go. (The joint of another program did not hold twist.)"""
    end = {"hold": "clamped", "to": to, "gap": True}
    held = changed(SWIMMER, {
        "rods.tail.strain_twist": [0, 0, 0.8], "rods.tail.start": end,
        "rods.tail.end": {"hold": "clamped"}, "bodies.ball.motion": "fixed",
    })  # fmt: skip
    _, system = system_from(held)
    assert abs(nodes_of(system, system.scene.initial)).max() < 1e-14
    _, seen = system.observe(system.scene.initial)
    moment = 0.29 * 0.8  # N_3 = a_3 (0 - 0.8)
    first = 0 if to == "ball" else 1
    assert seen["anchor_torque"][first] == pytest.approx([0, 0, moment], abs=1e-14)
    assert seen["anchor_torque"][-1] == pytest.approx([0, 0, -moment], abs=1e-14)
    loose = changed(held, {"rods.tail.start.motor": {"torque": 0.0}})
    _, system = system_from(loose)
    assert abs(nodes_of(system, system.scene.initial)).max() > 0.1


def test_a_mirrored_swimmer_moves_as_the_mirror_image():
    """Right-handed up, left-handed down, body mirrored in z = 0 (a half turn of its points)."""
    shape = {"kind": "helix", "radius": 0.3, "points": 9, "length": 1.6, "taper": 0.4}
    right = changed(SWIMMER, {
        "bodies.ball.shape.origin": [0, 0, 0], "rods.tail.strain_twist": [0, 0, 0],
        "rods.tail.shape": {**shape, "pitch": 1.1, "origin": [0, 0, 0.9]},
        "rods.tail.start.motor": {"rate": 0.7},
    })  # fmt: skip
    left = changed(right, {
        "bodies.ball.shape.rotate": {"axis": [0, 0, 1], "degrees": 180},
        "rods.tail.shape": {**shape, "pitch": -1.1, "origin": [0, 0, -0.9]},
        "rods.tail.start.motor": {"rate": -0.7},
        "rods.tail.moduli.bending": 0.4,
    })  # fmt: skip
    right = changed(right, {"rods.tail.moduli.bending": 0.4, "rods.tail.moduli.shear": 20.0})
    left = changed(left, {"rods.tail.moduli.shear": 20.0})
    here, there = (
        nodes_of(system, system.scene.initial).copy()
        for system in (system_from(case)[1] for case in (right, left))
    )
    mirror = np.array([1, 1, -1, -1, -1, 1])[:, None]
    assert there == pytest.approx(mirror * here, abs=1e-11 * abs(here).max())


@pytest.mark.parametrize("spacings", [2.0, 4.0])
@pytest.mark.parametrize("what", ["clamped", "hinged", "rate", "torque", "hook"])
def test_the_fastest_rate_does_not_rise(what, spacings):
    """Constraints take modes away; springs in their place would raise it 2 to 6 times."""
    free = changed(PLAIN, {"fluid.epsilon": {"spacings": spacings}, "rods.tail.shape.points": 13,
                           "rods.tail.strain_twist": [0, 0, 0]})  # fmt: skip
    ball = {"bodies": SWIMMER["bodies"], "rods.tail.start": SWIMMER["rods"]["tail"]["start"]}
    held = changed(free, {
        "clamped": {"rods.tail.start": {"hold": "clamped", "move": MOVE}},
        "hinged": {"rods.tail.start": {"hold": "hinged"}, "rods.tail.end": {"hold": "hinged"}},
        "rate": ball,
        "torque": {**ball, "rods.tail.start.motor": {"torque": 0.2}},
        "hook": {**ball, "rods.tail.start.hook": {"bending": 0.36 / 0.17}},
    }[what])  # fmt: skip
    free, held = (stability(system_from(case)[1]).rate for case in (free, held))
    assert held < 1.05 * free


def test_the_held_end_of_a_swimmer_goes_with_its_body():
    system, state = placed(SWIMMER)
    motion = nodes_of(system, state)
    body, end = motion[:, -1], motion[:, 0]
    arm = state.position[:, 0] - state.position[:, -1]
    size = abs(motion).max()
    assert end[:3] == pytest.approx(body[:3] + np.cross(body[3:], arm), abs=1e-12 * size)
    axis = system.scene.initial.director[2, :, 0]
    turn = state.director[:, :, -1].T @ system.scene.bodies[0].turn.T
    rate = 0.7 + 0.2 * np.sin(TIME)
    assert end[3:] == pytest.approx(body[3:] + rate * (turn @ axis), abs=1e-12 * size)
