"""What the fixed-step methods share: whole steps, counted."""

from rodsim.case.methods import Method
from rodsim.integrators.step import Step
from rodsim.scene.state import State
from rodsim.scene.system import RodSystem


class FixedStep:
    """Steps of equal size; time is counted, t_n = n * size, never accumulated."""

    method: Method
    fastest_rate = float("nan")

    def __init__(self, system: RodSystem, step: float):
        self.system = system
        self.size = step
        self.accepted = self.rejected = 0
        self.max_stages = self.method.stages

    def memory(self) -> dict:
        """Return what the steps to come depend on, for a checkpoint, and the counters."""
        return {"accepted": self.accepted, "spectral_radius": self.fastest_rate}

    def recall(self, memory: dict) -> None:
        """Take over what ``memory`` returned."""
        self.accepted, self.fastest_rate = memory["accepted"], memory["spectral_radius"]

    def increment(self, state: State):
        """Return the increments of one step from ``state``."""
        raise TypeError("a method defines its increment")

    def steps(self, state: State, end: float):
        """Yield the steps from ``state`` to ``end``, a whole number of them."""
        total = round(end / self.size)
        while self.accepted < total:
            y = self.increment(state)
            self.accepted += 1
            time = end if self.accepted == total else self.accepted * self.size
            after = self.system.state_at(state, time, y)
            yield Step(self.system, self.accepted, state, self.size, y, after)
            state = after
