"""What each integrator can do in a scene, known before the run, and watched during it."""

from dataclasses import dataclass

import numpy as np

from rodsim.case.methods import FIXED_STEP
from rodsim.errors import CaseError, StepFailure, UsageError
from rodsim.integrators.fastest_rate import FastestRate
from rodsim.integrators.rkc import RATE_SAFETY, stages_for

NEAR = 0.8  # of the limit: from here on a step is warned of
GROWN = 1.02  # of the limit: estimates come from below, so beyond this it is above for certain


@dataclass(frozen=True)
class Limits:
    """Fastest rate (1/time) at t = 0, largest stable steps by method, rkc's stages by step."""

    rate: float
    largest_steps: dict[str, float]
    stages: dict[float, int]


def stability(system, fastest: FastestRate | None = None) -> Limits:
    """Estimate the fastest rate rho of a system in its initial state, and what follows from it.

    Forward Euler is stable for h < 2/rho, RK4 for h < 2.785/rho, without a safety factor. The
    estimate, by Arnoldi iteration (``fastest``, where one is kept), comes from below; of 60 random
    scenes the worst was 0.1 % low.
    Raises UsageError where the rate is no number to compute with.
    """
    rho = (fastest or FastestRate(system)).estimate(system.scene.initial, tolerance=1e-6)
    if not (np.isfinite(rho) and rho > 0.0 and 1.0 / rho > 0.0):
        raise UsageError(
            f"the fastest rate of this scene comes out as {rho:.3g}: its numbers are too large or "
            "too small to compute with; choose other units"
        )
    steps = {name: method.limit / rho for name, method in FIXED_STEP.items()}
    sizes = [float(f"{factor / rho:.0e}") for factor in (1e1, 1e2, 1e3, 1e4)]
    return Limits(rho, steps, {h: stages_for(h, RATE_SAFETY * rho) for h in sizes})


def check_step(case, found: Limits) -> list:
    """Hold a fixed step against its limit; return the problems that only warn.

    Raises CaseError above the limit: the run would blow up.
    """
    method, step = case.time.integrator, case.time.step
    if method not in FIXED_STEP:
        return []
    limit = found.largest_steps[method]
    if step <= NEAR * limit:
        return []
    bound = f"the largest stable step of {method} here, {limit:.3g} (fastest rate {found.rate:.3g})"
    if step <= limit:
        reason = f"is {step / limit:.0%} of {bound}"
        return [case.source.problem(("time", "step"), reason)]
    remedy = "use a smaller step, or integrator: rkc, or run with --force"
    raise CaseError([case.source.problem(("time", "step"), f"is above {bound}: {remedy}")])


class RateWatch:
    """Follows the fastest rate through a run of fixed step: a wave that steepens may raise it.

    An unstable mode shows when it has outgrown the motion: the steps' increments then double every
    few steps. So the rate is estimated only where they have doubled, which costs nothing else.
    """

    def __init__(self, system, integrator, fastest: FastestRate):
        self.system, self.integrator = system, integrator
        self._fastest = fastest
        self._largest = 0.0

    def memory(self) -> dict:
        """Return what later estimates depend on, for a checkpoint."""
        return {"largest": self._largest, **self._fastest.memory()}

    def recall(self, memory: dict) -> None:
        """Take over what ``memory`` returned."""
        self._largest = memory["largest"]
        self._fastest.recall(memory)

    def follow(self, step) -> None:
        """Check the rate if the increments have doubled since it was last checked."""
        weights = self.system.weights
        largest = float(np.abs(step.increment[: weights.size] * weights).max())
        if largest > 2.0 * self._largest:
            self._largest = largest
            self.check(step.end)

    def check(self, state) -> None:
        """Raise StepFailure when the step has come to lie above the limit of stability."""
        integrator = self.integrator
        integrator.fastest_rate = self._fastest.estimate(state)
        limit = integrator.method.limit / integrator.fastest_rate
        if integrator.size > GROWN * limit:
            raise StepFailure(
                f"the fastest rate has grown to {integrator.fastest_rate:.3g}, "
                f"the largest stable step shrunk to {limit:.3g}",
                state,
            )
