"""How helical a rod is: radius, pitch and turns of its centreline, and the turns of its triads."""

from dataclasses import dataclass

import numpy as np

from rodsim.analysis.strain import strain_twist

STRAIGHT = 1e-9  # of the largest edge: bends below it are rounding, and have no direction


@dataclass(frozen=True)
class Helix:
    """A helix fitted to points: radius, pitch (length per turn, > 0 right-handed), turns (> 0)."""

    radius: float
    pitch: float
    turns: float


def fit_helix(position: np.ndarray) -> Helix:
    """Fit a helix to the centreline (M, 3) of an open rod, M >= 4.

    The second differences of a helix are all perpendicular to its axis, which is therefore their
    weakest singular direction. Across the axis a circle is fitted by least squares; turns are the
    angle swept round its centre over 2 pi, pitch the slope of height against angle times 2 pi.
    NaN for a straight rod and for fewer than 4 points, which lie on many helices.
    """
    bends = np.diff(position, n=2, axis=0)
    edge = np.linalg.norm(np.diff(position, axis=0), axis=1).max(initial=0.0)
    if len(position) < 4 or np.abs(bends).max() <= STRAIGHT * edge:
        return Helix(np.nan, np.nan, np.nan)
    across = np.linalg.svd(bends, full_matrices=True)[2]
    flat, axis = position @ across[:2].T, np.cross(across[0], across[1])
    system = np.column_stack([2.0 * flat, np.ones(len(flat))])
    *centre, rest = np.linalg.lstsq(system, np.sum(flat**2, axis=1), rcond=None)[0]
    angle = np.unwrap(np.arctan2(*(flat - centre).T[::-1]))
    slope = np.polyfit(angle, position @ axis, 1)[0]
    radius = np.sqrt(rest + np.dot(centre, centre))
    return Helix(float(radius), float(2.0 * np.pi * slope), float(np.ptp(angle) / (2.0 * np.pi)))


def radius(position: np.ndarray) -> float:
    """Return the radius, length, of the helix that :func:`fit_helix` finds."""
    return fit_helix(position).radius


def pitch(position: np.ndarray) -> float:
    """Return the pitch, length per turn, of the helix that :func:`fit_helix` finds."""
    return fit_helix(position).pitch


def turns(position: np.ndarray) -> float:
    """Return the number of turns of the helix that :func:`fit_helix` finds."""
    return fit_helix(position).turns


def triad_turns(director: np.ndarray, closed: bool = False) -> float:
    """Return the turns of the triads (M, 3, 3) about D^3: sum of 2 sin(theta/2) e^3 over 2 pi.

    For a rod at rest this is Omega_3 L / 2 pi, the number that eq. (45) calls turns; it is a
    twist number and not the number of turns of the helix. ``director[k, i]`` is D^(i+1).
    """
    twist = strain_twist(director, 1.0, closed)[:, 2]
    return float(np.sum(twist) / (2.0 * np.pi))
