"""Is the run still meaningful? Checked after every step; a run that is not stops by name."""

import numpy as np

from rodsim.errors import DivergedError, StepFailure
from rodsim.integrators.fixed import FixedStep
from rodsim.integrators.limits import RateWatch
from rodsim.integrators.step import Step
from rodsim.rods.state import State

FARTHEST = 1e3  # lengths of the scene: no rod drives itself that far in a run that works

FIXED_STEP_REMEDY = (
    "the fixed step is too long for this stiffness: halve time.step, or use integrator: rkc"
)
ADAPTIVE_REMEDY = (
    "the motion is beyond the resolution of the rods: use more points, or a smaller time.tolerance"
)


class Watch:
    """Checks that every value is finite, that no rod has left all bounds, and the fastest rate."""

    def __init__(self, system, integrator, follow_rate: bool = True):
        self.system = system
        fixed = isinstance(integrator, FixedStep)
        self.remedy = FIXED_STEP_REMEDY if fixed else ADAPTIVE_REMEDY
        self._rates = RateWatch(system, integrator) if fixed and follow_rate else None
        initial = system.scene.initial.position
        self.centre = initial.mean(axis=1, keepdims=True)
        extent = np.abs(initial - self.centre).max()
        self.farthest = FARTHEST * max(extent, system.scene.length_scale)
        self.last_good_frame = 0

    def state(self) -> dict:
        """Return what later checks depend on, for a checkpoint."""
        rates = self._rates.state() if self._rates else {}
        bounds = {"centre": self.centre, "farthest": self.farthest}
        return {**bounds, "last_good_frame": self.last_good_frame, **rates}

    def restore(self, state: dict) -> None:
        """Take over what ``state`` returned."""
        self.centre, self.farthest = state["centre"], state["farthest"]
        self.last_good_frame = state["last_good_frame"]
        if self._rates:
            self._rates.restore(state)

    def check(self, step: Step) -> None:
        """Raise DivergedError if the state at the end of a step means nothing."""
        state = step.end
        for name, values in (("position", state.position), ("director", state.director)):
            finite = np.isfinite(values).reshape(-1, values.shape[-1]).all(axis=0)
            if not finite.all():
                self._stop(step.number, step.start, f"{name} is not finite", int(finite.argmin()))
        distance = np.abs(state.position - self.centre).max(axis=0)
        if self._rates:
            self._rates.follow(step)
        if distance.max() > self.farthest:
            what = f"position has left all bounds, {distance.max():.3g} from the start"
            self._stop(step.number, step.start, what, int(distance.argmax()))

    def frame(self, number: int) -> None:
        """Remember the last good frame."""
        self.last_good_frame = number

    def stop(self, failure: StepFailure, number: int) -> None:
        """Raise DivergedError for a step that the integrator could not make."""
        self._stop(number, failure.state, str(failure), None)

    def _stop(self, number: int, before: State, what: str, point: int | None) -> None:
        turned = self.system.diagnose(before)
        if turned >= 0:
            point, what = turned, "the triad is a half-turn away from the next one"
        place = ""
        if point is not None:
            rod, k = self.system.scene.rods.locate(point)
            place = f", rod '{rod}', point {k}"
        raise DivergedError(
            f"diverged in step {number}, after t = {before.time:.6g}{place}: {what}.\n"
            f"Last good frame: {self.last_good_frame}. Usual cause: {self.remedy}"
        )
