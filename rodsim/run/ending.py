"""What the last lines of a run say: how small the gap got, how fast the rods still move."""

from __future__ import annotations

from collections import deque
from itertools import pairwise

import numpy as np

KEPT = 6  # frames
GROWTH, JUMP = 3.0, 20.0  # over several steps, in one
STILL = 1e-4  # of the longest rod's length: what points of a scene at rest would move until the end


def gap_sentence(smallest: float, time: float, diameter: float, units: dict) -> str:
    """Return how small the gap got, or an empty text where it was never measured."""
    if not np.isfinite(smallest):
        return ""
    length, unit = units["length"], units["time"]
    return (
        f"smallest gap {smallest:.3g} {length} at t = {time:.4g} {unit}; "
        f"the rods are {diameter:.3g} {length} thick"
    )


def sums_sentence(largest, accuracy: float) -> str:
    """Return how far the fast sums were from the exact ones, of what was asked.

    ``largest`` : the largest of the errors of u and of w that were measured at the frames.
    """
    u, w = largest
    far = ": not reached" if max(u, w) > accuracy else ""
    return f"fast sums: error of u up to {u:.2g}, of w {w:.2g}; {accuracy:g} asked{far}"


class SumErrors:
    """The largest errors of the fast sums that frames have; nothing where the sums are exact."""

    def __init__(self, accuracy: float | None):
        """``accuracy`` : what was asked of them, None for exact sums."""
        self._accuracy, self._largest = accuracy, np.zeros(2)

    def add(self, observables: dict) -> None:
        """Take in the observables of a frame."""
        if self._accuracy:
            self._largest = np.maximum(self._largest, observables["sum_error"])

    def read(self, run, frames: int) -> None:
        """Take in the first ``frames`` frames of a stored run."""
        if self._accuracy and frames:
            errors = run.observable("sum_error", slice(0, frames))
            self._largest = np.maximum(self._largest, errors.max(axis=0))

    def sentence(self) -> str:
        """Return what is to be said of them."""
        return sums_sentence(self._largest, self._accuracy) if self._accuracy else ""


class Motion:
    """How far points moved between the last steps of a run, seen at frames.

    Of the frames in one step only the last counts: the interpolant between is smooth to the
    tolerance, but its slope holds what the stiff modes make of it, and hides any slow growth.
    """

    def __init__(self, driven: bool):
        """``driven``: whether it is kept in motion from outside, so that growth says nothing."""
        self.driven, self._frames = driven, deque(maxlen=KEPT)

    def add(self, step: int, time: float, position: np.ndarray) -> None:
        """Take in the next frame: the number of its step, its time, positions (3, N)."""
        if self._frames and self._frames[-1][0] == step:
            self._frames.pop()
        self._frames.append((step, float(time), position.copy()))

    def read(self, run, frames: int) -> None:
        """Take in the last of the first ``frames`` frames of a stored run."""
        steps = run.steps[:frames]
        ends = np.append(np.flatnonzero(np.diff(steps)), frames - 1) if frames else ()
        for frame in ends[-KEPT:]:
            self.add(int(steps[frame]), run.time[frame], run.read("position", frame).T)

    def speeds(self) -> np.ndarray:
        """Return max_k |X_k - X_k before|/(t - t before) between the frames, oldest first."""
        pairs = pairwise(self._frames)
        return np.array(
            [np.linalg.norm(b - a, axis=0).max() / (end - t) for (_, t, a), (_, end, b) in pairs]
        )

    def still(self, end: float, length: float) -> bool:
        """Tell whether nothing moves any more: v * end <= 1e-4 length, v falling.

        v is the speed of the fastest point over the last step; ``end`` the time that the run is to
        take, which says what is slow in it; ``length`` that of the longest rod.
        """
        speeds = self.speeds()
        falling = speeds.size > 1 and speeds[-1] <= speeds[-2]
        return bool(not self.driven and falling and speeds[-1] * end <= STILL * length)

    def sentence(self, units: dict, rest=False) -> str:
        """Return how fast the fastest point moves and whether that grows; empty with one frame.

        ``rest`` : the run has ended because nothing moved any more.
        """
        speeds = self.speeds()
        if not speeds.size:
            return ""
        what = "fastest point" if self.driven else "still moving: fastest point"
        what = "nothing moves any more: fastest point" if rest else what
        span = self._frames[-1][1] - self._frames[-2][1]
        unit = f"{units['length']}/{units['time']}"
        text = f"{what} {speeds[-1]:.2g} {unit} over the last {span:.2g} {units['time']}"
        return text if self.driven else text + _trend(speeds)


def _trend(speeds):
    """Return whether speeds grow or fall, with where they come from; empty where neither shows.

    What is left of the steps' errors goes up and down by a few times from one to the next.
    """
    rises = _run_of(np.diff(speeds) > 0.0)
    growth = speeds[-1] / max(speeds[-1 - rises], np.finfo(float).tiny)
    if growth >= JUMP or (rises > 1 and growth >= GROWTH):
        return f", growing from {speeds[-1 - rises]:.2g}"
    falls = _run_of(np.diff(speeds) < 0.0)
    return f", slowing down from {speeds[-1 - falls]:.2g}" if falls > 1 else ""


def _run_of(flags):
    """Return how many of the last flags are set, without a break."""
    return int(np.argmin([*flags[::-1], False]))
