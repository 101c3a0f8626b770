"""How much steps of RKC grow: a grown step errs by what the correction does not follow."""

import numpy as np
import pytest
from scenes import final_state, last, system_of

from rodsim.integrators.defect import GROWN, MOST_GROWTH, most_growth
from rodsim.integrators.rkc import RKC, error_constant

SCENE = ("open_rod", "rods.rod.shape.points=12", "fluid.epsilon.spacings=3")
SIZE, STEPS = 2e-6, 60


class Even(RKC):
    """RKC with steps of one size."""

    def _accepted(self, state, f0, end):
        return SIZE, self.attempt(state, f0, SIZE)

    def _estimate_rate(self, state, f0):
        self.fastest_rate = 30.0 / SIZE


def errors(ratio):
    """Return the error of a step ``ratio`` times as long as those before, and their C h^3 y'''."""
    _, system = system_of(*SCENE)
    integrator = Even(system, 1e-6)
    step = last(integrator.steps(system.scene.initial, STEPS * SIZE))
    trial = integrator.attempt(step.end, integrator._rate, ratio * SIZE)
    third, n = integrator._defect._behind[0][0], system.rod_size
    uncorrected = error_constant(7) * SIZE**3 * third[:n] * system.weights[:n]
    return trial.error, np.sqrt(np.mean(uncorrected**2))


@pytest.mark.compiled
@pytest.mark.parametrize("ratio", [1.3, 1.7])
def test_a_grown_step_errs_by_what_its_correction_leaves(ratio):
    """C h^3 y''' (r^3 - 1); y''' changes by some per cent a step, the stages by one or two."""
    error, uncorrected = errors(ratio)
    assert error == pytest.approx(uncorrected * (ratio**3 - 1.0), rel=0.15)
    assert errors(1.0)[0] < 0.1 * uncorrected


@pytest.mark.parametrize("uncorrected", [0.05, 0.9, 7.0])
def test_growth_adds_no_more_than_its_share(uncorrected):
    assert uncorrected * (most_growth(uncorrected) ** 3 - 1.0) == pytest.approx(GROWN, rel=1e-12)
    assert most_growth(1e-4) == MOST_GROWTH


@pytest.mark.compiled
def test_tight_tolerances_reject_few_steps():
    """Grown by the error of the last step alone, every third step is rejected here."""
    *_, integrator = final_state(
        "open_rod", "rods.rod.shape.points=19", "time.end=3e-4", "time.tolerance=1e-9"
    )
    assert integrator.rejected < 0.03 * integrator.accepted
