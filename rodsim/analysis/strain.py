"""How much a rod is bent and twisted, from its triads."""

import numpy as np

from rodsim.forces.strain import strain_twist

__all__ = ["bend", "is_flat", "strain_twist"]


def is_flat(strain: np.ndarray) -> bool:
    """Tell whether strain twists (..., S, 3) bend about D^1 alone, as in a planar scene."""
    first, second = strain[..., 0], strain[..., 1]
    return bool(np.abs(second).max(initial=0.0) <= 1e-9 * np.abs(first).max(initial=0.0))


def bend(strain: np.ndarray) -> np.ndarray:
    """Return the curvature (..., S) of strain twists (..., S, 3), without a sign."""
    return np.hypot(strain[..., 0], strain[..., 1])
