"""Rigid blocks against their twin: one dense system for all points, motions and joints."""

import block_twin
import numpy as np
import pytest
from acting import changed
from held import SCENES, SWIMMER, TWO, out_of_place, turn_members
from scenes import system_from

from rodsim.scene.state import State

TIME = 0.3


def both(data, flow=None):
    """Return the twin's answer and rodsim's, at a state out of place: fields by name."""
    case, system = system_from(data)
    state = out_of_place(system, TIME)
    turn_members(case, system, state)
    placed = State(TIME, state.position.copy(), state.director.copy(), state.tracer, state.work)
    answer = block_twin.solve(case, system, placed, TIME, flow)
    out = system.velocities(TIME, state, system.zeros(), system.zeros())
    held = system.state_at(state, TIME, system.zeros())
    assert held.position == pytest.approx(placed.position, abs=1e-14)
    assert held.director == pytest.approx(placed.director, abs=1e-14)
    return answer, out[: 6 * system.scene.nodes].reshape(6, -1), system.observe(held)


def compare(answer, velocities, seen, tolerance):
    fields, observables = seen
    points = fields["position"].shape[1]
    size = abs(answer.velocities).max()
    assert velocities == pytest.approx(answer.velocities, abs=tolerance * size)
    loads = np.concatenate([fields["force"], fields["torque"]])
    scale = abs(answer.loads).max()
    assert loads == pytest.approx(answer.loads[:, :points], abs=tolerance * scale)
    if answer.holders:
        found = np.hstack([observables["anchor_force"], observables["anchor_torque"]])
        assert found == pytest.approx(np.array(answer.holders), abs=tolerance * scale)
    if answer.motors:
        torques, rates = np.array(answer.motors).T
        assert observables["motor_torque"] == pytest.approx(torques, abs=tolerance * scale)
        assert observables["motor_rate"] == pytest.approx(rates, abs=tolerance * size)


@pytest.mark.parametrize("name", SCENES)
def test_velocities_and_loads_are_those_of_the_dense_system(name):
    """Differences of the twin (spin of a turn, slope of a hook) are good to 1e-9; several blocks
    are iterated to 1e-10 of the dissipation's norm."""
    compare(*both(SCENES[name]), 1e-8)


@pytest.mark.parametrize("name", ["rate", "two bodies, four ends"])
def test_the_other_blob(name):
    compare(*both(changed(SCENES[name], {"fluid.blob": "algebraic9"})), 1e-8)


def test_in_a_background_flow():
    shear = ["0.4*z - 0.2*y", "0.3*x*t", "-0.1*y"]

    def flow(x, t):
        return np.array([0.4 * x[2] - 0.2 * x[1], 0.3 * x[0] * t, -0.1 * x[1]])

    compare(*both(changed(TWO, {"fluid.flow": shear}), flow), 1e-8)


@pytest.mark.parametrize("scene", [SWIMMER, SCENES["clamped and hinged in space"]])
def test_at_a_wall(scene):
    """The matrix of a block no longer is constant: it is iterated with that of the free fluid."""
    compare(*both(changed(scene, {"fluid.wall": {"z": -0.93}})), 1e-8)
