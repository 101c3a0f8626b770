"""How far two states of the same rods are apart."""

import numpy as np


def position_errors(position: np.ndarray, exact: np.ndarray) -> tuple[float, float]:
    """Return the largest and the root mean square distance of points, both arrays (3, N)."""
    distance = np.linalg.norm(position - exact, axis=0)
    return float(distance.max()), float(np.sqrt(np.mean(distance**2)))


def triad_angle(director: np.ndarray, exact: np.ndarray) -> float:
    """Return the largest angle, in degrees, between triads (3, 3, N), [i, component, point].

    From |D - E|^2 = 8 sin^2(angle/2), which keeps its digits at small angles.
    """
    chord = np.sqrt(np.sum((director - exact) ** 2, axis=(0, 1)) / 8.0)
    return float(np.degrees(2.0 * np.arcsin(np.clip(chord.max(), 0.0, 1.0))))
