"""Strain twist that changes in time: no step passes over it, none is taken for what it is not."""

import numpy as np
import pytest
from interrupted import DRIVEN, make

from rodsim import open_trajectory, simulate
from rodsim.errors import CaseError, DivergedError

PULSE = """
fluid: {viscosity: 1.3e-6, epsilon: 0.3}
rods:
  tail:
    shape: {kind: straight, points: 21, length: 2.1}
    moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}
    strain_twist: ["where(t > 3.01e-4, where(t < 3.41e-4, 8, 0), 0)", 0, 0]
time: {end: 1.1e-3}
output: {interval: 1.0e-4}
"""


def moved(tmp_path, *overrides):
    simulate(make(tmp_path, PULSE, overrides), tmp_path / "out.h5", overwrite=True)
    with open_trajectory(tmp_path / "out.h5") as run:
        return abs(run.position[-1] - run.position[0]).max()


@pytest.mark.compiled
def test_a_pulse_shorter_than_a_step_at_rest_is_seen(tmp_path):
    """Steps of a driven scene are no longer than output.interval; time.max_step cuts them more."""
    exact = moved(tmp_path, "time.integrator=rk4", "time.step=1e-6")
    assert exact > 0.02
    # jumps fall inside steps: their error is that of a step's share of the pulse
    assert moved(tmp_path, "time.max_step=1e-5") == pytest.approx(exact, rel=0.05)
    assert moved(tmp_path) > 0.5 * exact


def test_the_longest_step_is_an_interval_where_something_is_driven(tmp_path):
    driven = make(tmp_path, PULSE)
    assert driven.max_step_size == 1e-4
    assert make(tmp_path, PULSE, ["time.max_step=3e-5"]).max_step_size == 3e-5
    assert make(tmp_path, PULSE, ["rods.tail.strain_twist=['0.3*s', 0, 0]"]).max_step_size == np.inf


@pytest.mark.compiled
def test_no_step_is_longer_than_asked(tmp_path):
    slow = "rods.tail.strain_twist=['0.3*t', 0, 0]"  # some ten steps if they may be long
    simulate(make(tmp_path, PULSE, [slow, "time.max_step=3e-5"]), tmp_path / "out.h5")
    with open_trajectory(tmp_path / "out.h5") as run:
        assert run.runtime["steps_accepted"] >= 1.1e-3 / 3e-5


@pytest.mark.compiled
def test_what_rests_far_away_does_not_hide_a_drive(tmp_path):
    """The guard over the drive looks at what is driven of each rod alone."""
    wave = ["rods.tail.strain_twist=['0.02*cos(3*s + 4e4*t)', 0, 0]", "time.tolerance=0.9"]
    ring = """
  ring:
    shape: {kind: ring, radius: 2.5, points: 40, origin: [0, 300, 0]}
    moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}
    strain_twist: [2.5, 0, 0]
"""
    steps = []
    for more in ("", ring):
        text = PULSE.replace(
            "time: {end", f"{more.lstrip()}time: {{end".replace("ring:", "  ring:")
        )
        simulate(make(tmp_path, text, wave), tmp_path / "out.h5", overwrite=True)
        with open_trajectory(tmp_path / "out.h5") as run:
            steps.append(run.runtime["steps_accepted"])
    assert steps[1] >= steps[0] > 4 * 4e4 * 1.1e-3 / (2 * np.pi)


@pytest.mark.compiled
def test_a_drive_without_a_value_at_a_frame_stops_the_run_by_name(tmp_path):
    case = make(tmp_path, PULSE, ["rods.tail.strain_twist=['sin(9*(t-5e-4))/(t-5e-4)', 0, 0]"])
    with pytest.raises(DivergedError, match=r"the strain twist is not finite at t = 0\.0005"):
        simulate(case, tmp_path / "out.h5")
    with open_trajectory(tmp_path / "out.h5") as run:
        assert (run.frames, run.status) == (5, "diverged")


@pytest.mark.parametrize("drive", ["50*sin(2*pi*t/1.1e-3)", "where(t > 4e-4, 50*(t < 7e-4), 0)"])
def test_more_than_a_rest_state_has_is_refused_at_any_time(tmp_path, drive):
    with pytest.raises(CaseError, match=r"abs\(Omega\) ds = \d.* t = 0\.000\d+: above 2"):
        make(tmp_path, PULSE, [f"rods.tail.strain_twist=['{drive}', 0, 0]"])


def test_a_warning_at_the_start_hides_no_error_at_the_end(tmp_path):
    with pytest.raises(CaseError, match="above 2 there is no rest state"):
        make(tmp_path, DRIVEN, ["rods.tail.strain_twist=['14 + 9000*t', 0, 0]"])
