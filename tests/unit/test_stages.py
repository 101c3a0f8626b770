"""The compiled loop over stages against the method written out, one Python call per stage."""

import numpy as np
import pytest
from scenes import system_of

from rodsim.compiled import row as row_module
from rodsim.integrators.rkc import RKC, coefficients

DRIVEN = "rods.ring.strain_twist=['1.2*cos(40000*t + s)', 0, '0.3*t*1e4']"
SCENE = ("closed_ring_low_twist", "rods.ring.shape.points=14", "time.end=1e-4",
         "tracers.inner.along=4", "tracers.outer.along=2", "tracers.outer.around=3")  # fmt: skip
SIZE, STAGES = 3e-5, 7


def written_out(system, state, f0, size, s):
    """Y_j = (1 - mu - nu) Y_0 + mu Y_(j-1) + nu Y_(j-2) + h mu~ F_(j-1) + h gamma~ F_0."""
    table, start = coefficients(s), system.zeros()
    Y = [start, start + size * table[1, 2] * f0]
    for j in range(2, s + 1):
        mu, nu, mu_tilde, gamma_tilde, _ = table[j]
        F = system.rate(state.time + table[j - 1, 4] * size, state, Y[j - 1], system.zeros())
        Y.append(
            (1 - mu - nu) * start + mu * Y[j - 1] + nu * Y[j - 2]
            + size * (mu_tilde * F + gamma_tilde * f0)
        )  # fmt: skip
    return Y[s]


def one_step(overrides):
    _, system = system_of(*SCENE, *overrides)
    integrator = RKC(system, 1e-4)
    integrator.fastest_rate = (STAGES - 0.5) ** 2 / (1.54 * SIZE)
    state = system.scene.initial
    state.time = 1.3e-5
    f0 = system.velocities(state.time, state, system.zeros(), system.zeros())
    before = system.evaluations
    trial = integrator.attempt(state, f0, SIZE)
    return system, state, f0, trial, system.evaluations - before


@pytest.mark.parametrize("overrides", [(), (DRIVEN,), ("tracers=null",)])
def test_stages_are_those_of_the_method(overrides):
    system, state, f0, trial, evaluations = one_step(overrides)
    assert evaluations == STAGES
    expected = written_out(system, state, f0, SIZE, STAGES)
    # The same numbers but for rounding, of which s stages make about s^2 units.
    assert trial.increment == pytest.approx(expected, abs=1e-13 * abs(expected).max())
    end = state.time + SIZE
    tolerance = 1e-9 * abs(trial.rates).max()
    rates = system.rate(end, state, expected, system.zeros())
    assert trial.rates == pytest.approx(rates, abs=tolerance)
    velocities = system.velocities(end, state, expected, system.zeros())
    assert trial.velocities == pytest.approx(velocities, abs=tolerance)


@pytest.mark.parametrize("overrides", [(), (DRIVEN,)])
def test_the_geometry_left_by_a_step_is_that_of_its_increments(overrides):
    system, state, _, trial, _ = one_step(overrides)
    end = system.state_at(state, state.time + SIZE, trial.increment)
    assert all(map(np.array_equal, trial.geometry, end.geometry))
    assert not np.array_equal(trial.geometry[1], state.director)


def test_strain_twist_in_blocks_gives_the_same_bits(monkeypatch):
    *_, whole, made = one_step((DRIVEN,))
    monkeypatch.setattr(row_module, "LARGEST_BLOCK", 3 * 3 * 14)
    *_, blocks, made_in_blocks = one_step((DRIVEN,))
    assert made_in_blocks == made
    assert blocks.error == whole.error
    for one, other in zip(blocks[1:], whole[1:], strict=True):
        assert all(map(np.array_equal, one, other))


def test_strain_twist_at_several_times_is_that_of_each():
    _, system = system_of(*SCENE, DRIVEN)
    row, times = system.scene.parts[0].row, np.array([1e-5, 2e-5, 4e-5])
    together = row.at(times).reshape(3, 3, 14)
    for omega, t in zip(together, times, strict=True):
        assert np.array_equal(omega.ravel(), row(t))
    s = (np.arange(14) + 0.5) * 2 * np.pi * 2.5 / 14
    assert together[1, 0] == pytest.approx(1.2 * np.cos(0.8 + s), rel=1e-13)
    assert together[2, 2] == pytest.approx(0.12, rel=1e-13)


def test_travel_of_a_wave_is_its_phase_less_the_longest_part():
    """Over parts (2 j + 1)/36 of a step, j = 0 ... 5; the last is left out: 25/36 of the phase."""
    _, system = system_of("flagellum", "parameters.sigma=300")
    travel = system.scene.parts.travel
    for phase in (1e-3, 0.05):  # the chord of an arc is shorter by phase^2/24
        assert travel(1.7e-3, phase / 300.0) == pytest.approx(25.0 / 36.0 * phase, rel=1e-3)
    _, steady = system_of(*SCENE)
    assert steady.scene.parts.travel(1.7e-3, 0.2) == 0.0
