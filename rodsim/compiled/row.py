"""The row of a part: its numbers, some of which may depend on time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

TRAVEL_TIMES = np.append((np.arange(6) / 6) ** 2, 1.0)  # of a step
TRAVEL_PLACES = 100  # of a group, evenly spread, that are looked at
LARGEST_BLOCK = 1_000_000  # numbers evaluated ahead


@dataclass(frozen=True)
class Entry:
    """One number or expression in some places of a row.

    ``value`` : a number, or callable as f(s, t) with ``uses_t``; ``s`` (n,) : arc length at each
    place, or a single number where that does not matter; ``start`` : the first of the n places in
    the row; ``group`` : entries of a group are driven together (those of a rod).
    """

    value: object
    s: np.ndarray
    start: int
    group: object = None

    @property
    def driven(self) -> bool:
        """Whether it depends on time."""
        return callable(self.value) and self.value.uses_t

    @property
    def places(self) -> slice:
        """Where it stands in the row."""
        return slice(self.start, self.start + len(self.s))


class Row:
    """Numbers (size,) of a part at any time. What does not depend on t is evaluated once.

    Places that no entry names stay 0. ``watched``: entries of which only the travel is asked.
    """

    def __init__(self, size: int, entries=(), watched=()):
        self.size = size
        self._steady = np.zeros(size)
        for entry in entries:
            if not entry.driven:
                self._steady[entry.places] = _values(entry.value, entry.s, 0.0)
        self._driven = [entry for entry in entries if entry.driven]
        self._groups: dict = {}
        for entry in watched or self._driven:
            self._groups.setdefault(entry.group, []).append(entry)

    @property
    def driven(self) -> bool:
        """Whether any entry depends on time."""
        return bool(self._driven)

    def __call__(self, t: float) -> np.ndarray:
        """Return the numbers (size,) at time t."""
        return self.at(np.array([t]))[0]

    def at(self, times: np.ndarray) -> np.ndarray:
        """Return the numbers (T, size) at the first T of several times; T = 1 if not driven.

        T is cut where the array would be large: a long step of a large scene takes several calls.
        """
        if not self.driven:
            return self._steady[None]
        times = times[: max(2, LARGEST_BLOCK // self.size)]
        rows = np.empty((len(times), self.size))
        rows[:] = self._steady
        for entry in self._driven:
            rows[:, entry.places] = _values(entry.value, entry.s, times[:, None])
        return rows

    def travel(self, t: float, size: float) -> float:
        """Return how far the drive goes from t to t + size, over its own largest size.

        Of what is driven in a group, the sum of |x(t_j+1) - x(t_j)| over some times, less its
        largest term, over the largest |x(t_j)|, with |.| the root mean square over up to 100
        places: 0.7 sigma size for a short stretch of a wave of angular frequency sigma. The
        largest term is left out because a jump stays a jump however short the step; the times are
        not evenly spaced, so that a wave cannot look as if it stood still. The group that goes
        farthest counts; 0 if nothing is driven.
        """
        farthest, times = 0.0, (t + size * TRAVEL_TIMES)[:, None]
        for entries in self._groups.values():
            drive = np.concatenate([_values(e.value, _some(e.s), times) for e in entries], axis=1)
            gaps, largest = _norms(drive[1:] - drive[:-1]), _norms(drive).max()
            if largest > 0.0:
                farthest = max(farthest, float((gaps.sum() - gaps.max()) / largest))
        return farthest


def _values(value, s, times):
    return value(s, times) if callable(value) else value


def _some(s):
    stride = -(-len(s) // TRAVEL_PLACES)
    return s[stride // 2 :: stride]


def _norms(values):
    return np.sqrt(np.einsum("ij,ij->i", values, values))
