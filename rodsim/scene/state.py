"""The state of a scene and everything about it that does not change in time."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

TRAVEL_TIMES = np.append((np.arange(6) / 6) ** 2, 1.0)  # of a step
TRAVEL_SEGMENTS = 100  # of a rod, evenly spread, that are looked at
LARGEST_BLOCK = 1_000_000  # numbers of strain twist evaluated ahead


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
    """A case made ready to run: rods, fluid, intrinsic strain twist, initial state.

    ``moduli`` (6, N): of each segment, rod after rod. ``arrays``: by rod, what its strain twist was
    made from beside the case's text, by name. ``warnings``: Problems that do
    not stop a run and that only the geometry could tell.
    """

    rods: Rods
    strain_twist: StrainTwist
    epsilon: float
    viscosity: float
    blob: str
    planar: bool
    density: float | None
    tracer_groups: dict[str, int]
    initial: State
    moduli: np.ndarray | None = None
    arrays: dict = field(default_factory=dict)
    warnings: tuple = ()

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
        self._all = _Table(rods, entries, np.ones_like(rods.count))
        self._some = _Table(rods, entries, -(-rods.count // TRAVEL_SEGMENTS))

    @property
    def driven(self) -> bool:
        """True if any entry depends on time."""
        return bool(self._all.driven)

    def __call__(self, t: float) -> np.ndarray:
        """Return Omega (3, N), 1/length, at time t."""
        return self.at(np.array([t]))[0]

    def at(self, times: np.ndarray) -> np.ndarray:
        """Return Omega (T, 3, N) at the first T of several times; T = 1, for all, if not driven.

        T is cut where the array would be large: a long step of a large scene takes several calls.
        """
        steady = self._all.values
        most = max(2, LARGEST_BLOCK // steady.size)
        return self._all.at(times[:most]) if self.driven else steady[None]

    def travel(self, t: float, size: float) -> float:
        """Return how far the drive goes from t to t + size, over its own largest size.

        Of what is driven of a rod, the sum of |Omega(t_j+1) - Omega(t_j)| over some times, less its
        largest term, over the largest |Omega(t_j)|, with |.| the root mean square over up to 100
        segments: 0.7 sigma size for a short stretch of a wave of angular frequency sigma. The
        largest term is left out because a jump stays a jump however short the step; the times are
        not evenly spaced, so that a wave cannot look as if it stood still. Of several rods the one
        that goes farthest counts; 0 if nothing is driven.
        """
        farthest, values = 0.0, self._some.at(t + size * TRAVEL_TIMES) if self.driven else None
        for rows, columns in self._some.drives:
            drive = values[:, rows, columns].reshape(len(TRAVEL_TIMES), -1)
            gaps, largest = _row_norms(drive[1:] - drive[:-1]), _row_norms(drive).max()
            if largest > 0.0:
                farthest = max(farthest, float((gaps.sum() - gaps.max()) / largest))
        return farthest


def _row_norms(values):
    return np.sqrt(np.einsum("ij,ij->i", values, values))


class _Table:
    """Strain twist (3, n) at every ``strides[r]``-th segment of rod r, one rod after another.

    ``values``: all that does not depend on time; ``driven``: (expression, s, row, columns) of all
    that does; ``drives``: (rows, columns) of it, by rod. The segment that an open rod does not have
    stays 0.
    """

    def __init__(self, rods, entries, strides):
        ends = np.cumsum(-(-rods.count // strides))
        self.values, self.driven, self.drives = np.zeros((3, ends[-1])), [], []
        begin = 0
        for r, triple in enumerate(entries):
            s = (np.arange(rods.segments[r]) + 0.5) * rods.spacing[r]
            s = s[strides[r] // 2 :: strides[r]]
            columns, rows = slice(begin, begin + len(s)), []
            for row, entry in enumerate(triple):
                if not callable(entry):
                    self.values[row, columns] = entry
                elif entry.uses_t:
                    self.driven.append((entry, s, row, columns))
                    rows.append(row)
                else:
                    self.values[row, columns] = entry(s, 0.0)
            if rows:
                self.drives.append((rows, columns))
            begin = int(ends[r])

    def at(self, times):
        """Return the strain twist (T, 3, n) at several times."""
        omegas = np.empty((len(times), *self.values.shape))
        omegas[:] = self.values
        for expression, s, row, columns in self.driven:
            omegas[:, row, columns] = expression(s, times[:, None])
        return omegas
