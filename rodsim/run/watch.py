"""Is the run still meaningful? Checked after every step; a run that is not stops by name."""

import math

import numpy as np

from rodsim.case.check import ABSURD
from rodsim.compiled.flags import MAT, TRIADS, kernel
from rodsim.errors import DivergedError, StepFailure
from rodsim.files import DEFAULT_OUTPUT
from rodsim.integrators.limits import RateWatch
from rodsim.integrators.step import Step
from rodsim.scene.state import State

FARTHEST = 1e3  # lengths of the scene: no rod drives itself that far in a run that works


def _fixed_step_remedy(case, system):
    """Return the usual cause of a fixed step that fails and what to do, and the change for it."""
    cause = "the fixed step is too long for this stiffness: halve time.step, or use integrator: rkc"
    return cause, "time.integrator=rkc"


def _adaptive_remedy(case, system):
    """Return the same for steps that follow the error."""
    finer = f"time.tolerance={max(0.1 * case.time.tolerance, 1e-13):.3g}"
    scene = system.scene
    share = scene.epsilon / scene.rods.spacing.min()
    if 1.0 / ABSURD < share < ABSURD:
        advice = "use more points, or a smaller time.tolerance"
    else:
        advice = f"check the units, epsilon is {share:.2g} spacings"
    return f"the motion is beyond the resolution of the rods: {advice}", finer


@kernel(f"boolean({MAT}, {TRIADS}, {MAT}, float64)")
def _in_order(X, D, centre, farthest):
    """Tell whether all is finite and within bounds: one pass, after every step."""
    for c in range(3):
        for k in range(np.uint64(X.shape[1])):
            if not abs(X[c, k] - centre[c, 0]) <= farthest:
                return False
            for i in range(3):
                if not math.isfinite(D[i, c, k]):
                    return False
    return True


class Watch:
    """Checks that every value is finite, that no rod has left all bounds, and the fastest rate."""

    def __init__(self, case, system, integrator, fastest=None):
        """``fastest``: the FastestRate that follows the rate of a fixed step, or None."""
        self.system, self._command = system, case.source.command
        self.output = DEFAULT_OUTPUT  # what the command of a remedy writes
        self._fixed = fixed = not integrator.method.adaptive
        self._guards = system.scene.parts.guards
        self.remedy = (_fixed_step_remedy if fixed else _adaptive_remedy)(case, system)
        self._rates = RateWatch(system, integrator, fastest) if fixed and fastest else None
        self.wall, self.floor = system.scene.wall, system.scene.floor
        initial = system.scene.initial.position
        self.centre = initial.mean(axis=1, keepdims=True)
        extent = np.abs(initial - self.centre).max()
        self.farthest = FARTHEST * max(extent, system.scene.length_scale)
        self.last_good_frame = 0

    def memory(self) -> dict:
        """Return what later checks depend on, for a checkpoint."""
        rates = self._rates.memory() if self._rates else {}
        bounds = {"centre": self.centre, "farthest": self.farthest}
        return {**bounds, "last_good_frame": self.last_good_frame, **rates}

    def recall(self, memory: dict) -> None:
        """Take over what ``memory`` returned."""
        self.centre, self.farthest = memory["centre"], memory["farthest"]
        self.last_good_frame = memory["last_good_frame"]
        if self._rates:
            self._rates.recall(memory)

    def check(self, step: Step) -> None:
        """Raise DivergedError if the state at the end of a step means nothing."""
        state = step.end
        within = _in_order(state.position, state.director, self.centre, self.farthest)
        if within and not self._below_wall(state):
            if self._rates:
                self._rates.follow(step)
            self._ask_guards(step)
            return
        for name, values in (("position", state.position), ("director", state.director)):
            finite = np.isfinite(values).reshape(-1, values.shape[-1]).all(axis=0)
            if not finite.all():
                self._stop_on_the_way_to_the_wall(step)
                self._stop(step.number, step.start, f"{name} is not finite", int(finite.argmin()))
        distance = np.abs(state.position - self.centre).max(axis=0)
        if self._rates:
            self._rates.follow(step)
        if self._below_wall(state):
            self._stop_below_the_wall(step)
        if distance.max() > self.farthest:
            what = f"position has left all bounds, {distance.max():.3g} from the start"
            self._stop(step.number, step.start, what, int(distance.argmax()))

    def _ask_guards(self, step):
        """Raise DivergedError where a step or its end is not what the parts can follow."""
        for guard in self._guards:
            breach = guard.breach(step.end)
            if breach:
                what, *remedy = breach
                self._stop(step.number, step.start, what, None, remedy)
            if self._fixed and guard.share(*self.system.split(step.increment)[:2]) > 1.0:
                self._stop(step.number, step.start, guard.beyond, None)

    def _below_wall(self, state):
        if self.wall is None:
            return False
        above = state.tracer[2] >= self.floor  # False for NaN
        return state.position[2].min() <= self.wall or not above.all()

    def _stop_below_the_wall(self, step):
        z, tracers = step.end.position[2], step.end.tracer[2]
        if z.min() <= self.wall:
            what = f"is at z = {z.min():.6g}, not above the wall, z = {self.wall:g}"
            self._stop(step.number, step.start, what, int(z.argmin()))
        k = int(np.argmin(tracers >= self.floor))
        before = step.start.tracer[2, k]
        what = f"tracer {k} goes from z = {before:.6g} through the wall, z = {self.wall:g}"
        self._stop(step.number, step.start, what, None)

    def _stop_on_the_way_to_the_wall(self, step):
        """Raise DivergedError where a stage has come to the wall: its rates are not finite.

        Seen by the velocities at the start of the step.
        """
        if self.wall is None:
            return
        start, zero = step.start, self.system.zeros()
        u = self.system.velocities(start.time, start, zero, self.system.zeros())
        z = start.position[2]
        ahead = z + step.size * self.system.split(u)[0][2]
        k = int(ahead.argmin())
        if ahead[k] <= self.wall:
            what = f"goes from z = {z[k]:.6g} to the wall, z = {self.wall:g}, or beyond in the step"
            self._stop(step.number, start, what, k)

    def frame(self, number: int) -> None:
        """Remember the last good frame."""
        self.last_good_frame = number

    def stop(self, failure: StepFailure, number: int) -> None:
        """Raise DivergedError for a step that the integrator could not make."""
        self._stop(number, failure.state, str(failure), None)

    def _stop(self, number: int, before: State, what: str, point: int | None, remedy=None) -> None:
        turned = self.system.diagnose(before)
        if turned >= 0:
            point, what = turned, "the triad is a half-turn away from the next one"
        place = ""
        if point is not None:
            place = f", {self.system.scene.name_of(point)}"
        cause, change = remedy or self.remedy
        raise DivergedError(
            f"diverged in step {number}, after t = {before.time:.6g}{place}: {what}.\n"
            f"Last good frame: {self.last_good_frame}. Usual cause: {cause}.\n"
            f"Try: {self._command(change, output=self.output)}"
        )
