"""The state of a scene and everything about it that does not change in time."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

TRAVEL_SAMPLES = 6
LARGEST_BLOCK = 1_000_000  # numbers of strain twist evaluated ahead
HALF_TURN = 4e-14  # 1 + tr A of neighbouring triads below this has lost every digit


@dataclass
class State:
    """Positions and triads of all rods, one rod after another, and the tracers.

    position (3, N), length; director (3, 3, N), [i, component, point] is D^(i+1); tracer (3, P).
    """

    time: float
    position: np.ndarray
    director: np.ndarray
    tracer: np.ndarray


@dataclass(frozen=True)
class Rods:
    """Tables of the R rods: names, node ranges, spacing, closedness, moduli (6, R).

    moduli rows: a_1, a_2, a_3 (mass length^3 time^-2), b_1, b_2, b_3 (mass length time^-2).
    """

    names: tuple[str, ...]
    first: np.ndarray
    count: np.ndarray
    closed: np.ndarray
    spacing: np.ndarray
    moduli: np.ndarray

    @property
    def points(self) -> int:
        """Number of points N of all rods."""
        return int(self.count.sum())

    @property
    def tables(self):
        """The arguments that every kernel of ``elasticity.py`` takes for its rods."""
        return self.first, self.count, self.closed, self.spacing, self.moduli

    @property
    def segments(self) -> np.ndarray:
        """Number of segments of each rod, (R,)."""
        return np.where(self.closed, self.count, self.count - 1)

    @property
    def lengths(self) -> np.ndarray:
        """Unstressed length of each rod, (R,)."""
        return self.segments * self.spacing

    def locate(self, point: int) -> tuple[str, int]:
        """Return the rod's name and the number within it of a point of the whole scene."""
        r = int(np.searchsorted(self.first, point, side="right")) - 1
        return self.names[r], int(point - self.first[r])


@dataclass(frozen=True)
class Scene:
    """A case made ready to run: rods, fluid, intrinsic strain twist, initial state."""

    rods: Rods
    strain_twist: StrainTwist
    epsilon: float
    viscosity: float
    blob: str
    planar: bool
    density: float | None
    tracer_groups: dict[str, int]
    initial: State

    @property
    def length_scale(self) -> float:
        """Unstressed length of the longest rod: the scale of every error norm."""
        return float(self.rods.lengths.max())


class StrainTwist:
    """Intrinsic strain twist (Omega_1, Omega_2, Omega_3) at the middle of each segment.

    Segment k of a rod lies at s = (k + 1/2) ds. Entries that do not depend on t are evaluated
    once; a scene without any that does gets the same array back at every call.
    """

    def __init__(self, rods: Rods, entries):
        """``entries``: for each rod three numbers or expressions, callable as f(s, t)."""
        self._values = np.zeros((3, rods.points))
        self._driven = []
        for r, triple in enumerate(entries):
            nodes = slice(int(rods.first[r]), int(rods.first[r] + rods.segments[r]))
            s = (np.arange(rods.segments[r]) + 0.5) * rods.spacing[r]
            for i, entry in enumerate(triple):
                if not callable(entry):
                    self._values[i, nodes] = entry
                elif entry.uses_t:
                    self._driven.append((entry, s, self._values[i, nodes]))
                else:
                    self._values[i, nodes] = entry(s, 0.0)

    @property
    def driven(self) -> bool:
        """True if any entry depends on time."""
        return bool(self._driven)

    def at(self, times: np.ndarray) -> np.ndarray:
        """Return Omega (T, 3, N) at the first T of several times; T = 1, for all, if not driven.

        T is cut where the array would be large: a long step of a large scene takes several calls.
        """
        if not self.driven:
            return self._values[None]
        most = max(2, LARGEST_BLOCK // self._values.size)
        return np.array([self(t).copy() for t in times[:most]])

    def travel(self, t: float, size: float) -> float:
        """Return how far Omega goes from t to t + size, over its own largest size; 0 if not driven.

        The sum of |Omega(t_j+1) - Omega(t_j)| over some times, less its largest term, over the
        largest |Omega(t_j)|, with |.| the root mean square over the segments: 0.7 sigma size for a
        short stretch of a wave of angular frequency sigma. The largest term is left out because
        a jump stays a jump however short the step; the times are not evenly spaced, so that a wave
        cannot look as if it stood still.
        """
        if not self.driven:
            return 0.0
        values = [self(t + size * (j / TRAVEL_SAMPLES) ** 2).copy() for j in range(TRAVEL_SAMPLES)]
        values.append(self(t + size))
        gaps = [np.linalg.norm(b - a) for a, b in pairwise(values)]
        largest = max(np.linalg.norm(value) for value in values)
        return float((sum(gaps) - max(gaps)) / largest) if largest > 0.0 else 0.0

    def __call__(self, t: float) -> np.ndarray:
        """Return Omega (3, N), 1/length, at time t; valid until the next call."""
        for expression, s, view in self._driven:
            view[:] = expression(s, t)
        return self._values
