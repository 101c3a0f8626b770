"""A rod held against itself: distances of its points, triads along its chords, rounding."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rodsim.vectors import cross

WARN, REFUSE = 0.01, 0.2  # relative; of a tilt, its sine
WARN_TILT = np.radians(1.0)
SAME = 1e-6  # spacings: two points are one
ROUNDED, LOST = 1e-8, 1e-3  # rounding of a position over the spacing


@dataclass(frozen=True)
class Geometry:
    """Chords of a rod (3, M) and its triads (3, 3, M) against its spacing and each other."""

    position: np.ndarray
    director: np.ndarray
    spacing: float
    closed: bool

    @cached_property
    def chords(self) -> np.ndarray:
        """X_(k+1) - X_k of each segment, (3, S)."""
        return self._segments(np.roll(self.position, -1, axis=1) - self.position)

    @cached_property
    def distances(self) -> np.ndarray:
        """Lengths of the chords over the spacing, (S,)."""
        return np.linalg.norm(self.chords, axis=0) / self.spacing

    @cached_property
    def tilt(self) -> np.ndarray:
        """Angle from each chord to the mean of D^3 at its two ends, rad, (S,)."""
        return self.tilt_of(self.director[2])

    @property
    def ends(self) -> float:
        """Distance of the last point from the first over the spacing."""
        return float(np.linalg.norm(self.position[:, 0] - self.position[:, -1]) / self.spacing)

    def tilt_of(self, third, mean=True) -> np.ndarray:
        """Return the angles of some D^3 (3, M) to the chords; ``mean``: of those at both ends."""
        along = self._segments(third + np.roll(third, -1, axis=1) if mean else third)
        across = np.linalg.norm(cross(along, self.chords), axis=0)
        return np.arctan2(across, np.sum(along * self.chords, axis=0))

    def _segments(self, values):
        return values if self.closed else values[..., :-1]


def rounding(position: np.ndarray, spacing: float) -> float:
    """Return the rounding of the largest coordinate over the spacing of the points."""
    return float(np.spacing(np.abs(position).max()) / spacing)


def check_rounding(position, spacing):
    """Return (errors, warnings) of a rod whose positions are too large for float64."""
    share = rounding(position, spacing)
    if share < ROUNDED:
        return [], []
    far = np.abs(position).max()
    reason = f"positions up to {far:.3g} are rounded to {share:.2g} of the spacing {spacing:.3g}"
    if share >= LOST:
        return [f"{reason}: move everything nearer to 0"], []
    return [], [f"{reason}: small strains are lost; move everything nearer to 0"]


def check_geometry(geometry: Geometry, name=str):
    """Return (errors, warnings): what a rod's points, spacing and triads say of each other.

    ``name``: what point k is called. Warned of beyond 1 % or 1 degree; an error beyond 20 % (of a
    tilt: of its sine, the shear strain), at a zero distance, or D3 against the chord.
    """
    errors, warnings = [], []
    coincident = _coincident(geometry, name)
    if coincident:
        return [coincident], []
    off = np.abs(geometry.distances - 1.0).max()
    if off > WARN:
        (errors if off > REFUSE else warnings).append(_distances(geometry, name))
    near = np.abs(geometry.distances / np.median(geometry.distances) - 1.0) <= REFUSE
    tilt = geometry.tilt[near].max()  # of a segment that is none, the distance has been told
    if tilt > WARN_TILT:
        against = tilt > np.arcsin(REFUSE)
        (errors if against else warnings).append(_tilt(geometry, name))
    count = geometry.position.shape[1]
    if not geometry.closed and count > 3 and geometry.ends < 1.0 + REFUSE:
        apart = f"its ends are {geometry.ends:.3g} spacings apart"
        warnings.append(f"{apart}: a closed curve is given with closed: true")
    return errors, warnings


def _coincident(geometry, name):
    """Return what is wrong where two neighbours are one point."""
    distances, count = geometry.distances, geometry.position.shape[1]
    if not geometry.closed and geometry.ends < SAME and count > 3:
        again = "the last point is the first one again"
        return f"{again}: for a closed curve take the last row out and add closed: true"
    same = np.flatnonzero(distances < SAME)
    if not len(same):
        return None
    if same[0] == count - 1:
        return "the last point is the first one again: a closed curve has each point once"
    pair = f"{name(same[0])} and {name(same[0] + 1)} are the same"
    return f"{pair}: a point is given twice" + f", and {len(same) - 1} more" * (len(same) > 1)


def _distances(geometry, name):
    """Return what the distances of the points are, and the likely slip."""
    distances = geometry.distances
    low, mean, high = distances.min(), distances.mean(), distances.max()
    found = f"points are {low:.4g} to {high:.4g} spacings apart, {mean:.4g} in the mean"
    return f"{found}: {_distance_slip(distances, geometry, name)}"


def _distance_slip(distances, geometry, name):
    typical = np.median(distances)
    odd = np.flatnonzero(np.abs(distances / typical - 1.0) > REFUSE)
    fits = f"{typical * geometry.spacing:.6g}"
    if np.abs(distances / typical - 1.0).max() <= WARN:
        unit = abs(np.log10(typical)) > 1.5
        advice = ", or the positions in another unit" if unit else ""
        return f"is spacing wrong{advice}? the distance in the table is {fits}"
    if not len(odd):
        return "uneven points, or chords of a coarse curve: kind: curve makes them even"
    if geometry.closed and odd.tolist() == [len(distances) - 1]:
        apart = f"the last is {distances[-1] / typical:.4g} of the others' distance from the first"
        return f"{apart}: is the curve closed?"
    if len(odd) <= max(1, len(distances) // 50):
        k = int(odd[0])
        jump = (
            f"a jump from {name(k)} to {name(k + 1)}, {distances[k] / typical:.4g} times the others"
        )
        return f"{jump}: a point left out or moved, or two curves in one table?"
    return "uneven points: kind: curve makes them even"


def _tilt(geometry, name):
    """Return how far D3 is from the chords, and the likely slip."""
    tilt = np.degrees(geometry.tilt)
    k = int(np.argmax(tilt))
    found = f"D3 is {tilt.mean():.3g} degrees from the chords in the mean, {tilt[k]:.3g} after"
    return f"{found} {name(k)}: {_tilt_slip(geometry)}"


def _tilt_slip(geometry):
    """Return what would bring D3 to the chords."""
    D = geometry.director
    third = {
        "D3 points against the order of the points: rows reversed, or D3 negated": -D[2],
        "are the triads transposed? a row has D1x D1y D1z D2x D2y D2z D3x D3y D3z": D[:, 2],
        "D1 lies along the chords: are the triads' vectors in another order?": D[0],
        "D2 lies along the chords: are the triads' vectors in another order?": D[1],
    }
    tilts = {words: geometry.tilt_of(vectors).mean() for words, vectors in third.items()}
    first = "D3 lies along the chord after its point: triads belong to points, not to segments"
    tilts[first] = geometry.tilt_of(D[2], mean=False).mean()
    words = min(tilts, key=tilts.get)
    if (
        tilts[words] < max(0.2 * geometry.tilt.mean(), 1e-3)
        or tilts[words] < 5.0 * WARN_TILT < geometry.tilt.mean()
    ):
        return words
    return "the triads do not follow the curve"
