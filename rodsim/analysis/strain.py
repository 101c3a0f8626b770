"""How much a rod is bent and twisted, from its triads."""

import numpy as np

from rodsim.forces.strain import strain_twist

__all__ = ["at_points", "bend", "is_flat", "strain_twist"]


def is_flat(strain: np.ndarray) -> bool:
    """Tell whether strain twists (..., S, 3) bend about D^1 alone, as in a planar scene."""
    first, second = strain[..., 0], strain[..., 1]
    return bool(np.abs(second).max(initial=0.0) <= 1e-9 * np.abs(first).max(initial=0.0))


def bend(strain: np.ndarray) -> np.ndarray:
    """Return the curvature (..., S) of strain twists (..., S, 3), without a sign."""
    return np.hypot(strain[..., 0], strain[..., 1])


def at_points(rods, triads: np.ndarray) -> np.ndarray:
    """Return curvature and twist (2, N) at the points: the mean of the segments on both sides.

    triads (N, 3, 3) of all ``rods``, rows D^1, D^2, D^3.
    """
    parts = []
    for rod in rods:
        strain = strain_twist(triads[rod.nodes], rod.spacing, rod.closed)
        values = np.stack([bend(strain), strain[:, 2]], axis=1)
        before = np.roll(values, 1, axis=0) if rod.closed else np.vstack([values[:1], values])
        after = values if rod.closed else np.vstack([values, values[-1:]])
        parts.append(0.5 * (before + after))
    return np.concatenate(parts).T
