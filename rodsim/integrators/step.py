"""What every integrator hands to the run: one accepted step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from rodsim.case.methods import Method
from rodsim.compiled.rotations import angular_velocity
from rodsim.scene.state import State
from rodsim.scene.system import RodSystem


@dataclass(slots=True)
class Step:
    """A step from ``start`` over ``size`` in time, with end increments and both end rates.

    ``increment`` (6 N + 3 P,) leads from ``start`` to ``end``; ``rates`` are dy/dt at both ends,
    or None for methods without dense output.
    """

    system: RodSystem
    number: int
    start: State
    size: float
    increment: np.ndarray
    end: State
    rates: tuple[np.ndarray, np.ndarray] | None = None

    def at(self, time: float) -> State:
        """Return the state at a time inside the step: cubic Hermite on the increments.

        With x = (time - start)/size: y = x^2 (3 - 2 x) y_1 + size x (1 - x) [(1 - x) f_0 - x f_1],
        error O(size^4), so it does not lower the order of a method of order 2 or 3.
        """
        if time == self.end.time or self.rates is None:  # fixed steps end at their frames
            return self.end
        x = (time - self.start.time) / self.size
        return self.system.state_at(self.start, time, self._increment(x))

    def velocities_at(self, time: float) -> np.ndarray | None:
        """Return (u, w) of the rods (6, N) at a time inside the step, the derivative of ``at``.

        y' = 6 x (1 - x) y_1/size + (1 - x)(1 - 3 x) f_0 + x (3 x - 2) f_1, error O(size^3). An
        evaluation there would be worse: it multiplies what the interpolant leaves in the stiff
        modes by their rates. None for methods without dense output.
        """
        if self.rates is None:
            return None
        x = (time - self.start.time) / self.size
        shift, turn, _ = self.system.split(self._slope(x))
        theta = self.system.split(self._increment(x))[1]
        return np.concatenate([shift, angular_velocity(theta, turn)])

    def powers_at(self, time: float) -> np.ndarray | None:
        """Return the rates of the ledger (W,) at a time inside the step, as ``velocities_at``."""
        if self.rates is None:
            return None
        return self._slope((time - self.start.time) / self.size)[self.system.ledger]

    def _slope(self, x):
        f0, f1 = self.rates
        slope = 6.0 * x * (1.0 - x) / self.size * self.increment
        return slope + (1.0 - x) * (1.0 - 3.0 * x) * f0 + x * (3.0 * x - 2.0) * f1

    def _increment(self, x):
        f0, f1 = self.rates
        y = x * x * (3.0 - 2.0 * x) * self.increment
        return y + self.size * x * (1.0 - x) * ((1.0 - x) * f0 - x * f1)


class Integrator(Protocol):
    """One method in time. ``steps`` yields accepted steps until ``end`` is reached exactly."""

    method: Method
    accepted: int
    rejected: int
    max_stages: int
    fastest_rate: float

    def steps(self, state: State, end: float):
        """Yield :class:`Step` after :class:`Step` from ``state`` to ``end``."""

    def memory(self) -> dict:
        """Return what the steps to come depend on beside the state of the rods, and the counters.

        Arrays and numbers by name, always of the same shapes and types. Between two steps.
        """

    def recall(self, memory: dict) -> None:
        """Take over what ``memory`` returned: ``steps`` then goes on with the same bits."""
