"""Observed orders in time, positions and triads, on the open rod in motion."""

import numpy as np
import pytest
from scenes import difference, final_state, system_of

from rodsim.integrators.rkc import RKC

# Few points and a blob of 3 spacings: stiff enough to need stages, cheap enough without the JIT.
SCENE = ("open_rod", "rods.rod.shape.points=20", "fluid.epsilon.spacings=3")
END = 4e-4


class FixedSteps(RKC):
    """RKC2 at a step of our choice: the method without its controller."""

    def _accepted(self, state, f0, end):
        return self.step, *self.attempt(state, f0, self.step)[:3]


def settled():
    """The scene, past the first transient, in which no step of the test resolves the fast modes."""
    case, system = system_of(*SCENE, "time.end=2e-4", "time.tolerance=1e-9")
    integrator = RKC(system, case.time.tolerance)
    for step in integrator.steps(system.scene.initial, case.time.end):
        pass
    return system, step.end


def run_rkc(system, start, size):
    integrator = FixedSteps(system, 1e-4)
    integrator.step = size
    for step in integrator.steps(start, start.time + END):
        if step.end.time > start.time + END - 0.5 * size:
            return step.end
    raise AssertionError("did not reach the end")
