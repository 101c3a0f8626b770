"""Strain twist of triads: the discrete strains that the energy (6) compares with Omega."""

import numpy as np


def strain_twist(director: np.ndarray, spacing: float, closed: bool = False) -> np.ndarray:
    """Return the strain twist of each segment, 2 sin(theta/2) e^i / ds, (..., S, 3), 1/length.

    The numbers (D^j' . D^l) of (24)-(26) that the energy (6) compares with Omega: the first two
    are the curvatures about D^1 and D^2, the third the twist. theta is the angle and e the axis
    of the rotation from one triad to the next, e^i its components along the triad.
    ``director`` is (..., M, 3, 3) with [k, i, :] = D^(i+1); S = M - 1, or M for a closed rod.
    Not finite at a half-turn, and where ``director`` holds no triads.
    """
    after = np.roll(director, -1, axis=-3)
    pairs = director.shape[-3] if closed else director.shape[-3] - 1
    here, after = director[..., :pairs, :, :], after[..., :pairs, :, :]
    axial = 0.5 * np.cross(here, after).sum(axis=-2)
    along = np.einsum("...c,...ic->...i", axial, here)
    with np.errstate(invalid="ignore", divide="ignore"):
        cosine = 0.5 * np.sqrt(1.0 + np.einsum("...ic,...ic->...", here, after))
        return along / (cosine[..., None] * spacing)


def strains(position: np.ndarray, director: np.ndarray, spacing: float, closed: bool) -> np.ndarray:
    """Return all six strains of each segment, (S, 6): strain twist, then D^i . X' - delta_3i.

    position (M, 3), director (M, 3, 3). The triad of a half point is the mean of its neighbours'
    with what a rotation by half the angle leaves of it, as in :mod:`rodsim.forces.elasticity`.
    """
    twist = strain_twist(director, spacing, closed)
    pairs = len(twist)
    here, after = director[:pairs], np.roll(director, -1, axis=0)[:pairs]
    axial = 0.5 * np.cross(here, after).sum(axis=1)
    along = np.einsum("kc,kic->ki", axial, here)
    with np.errstate(invalid="ignore", divide="ignore"):
        cosine = 0.5 * np.sqrt(1.0 + np.einsum("kic,kic->k", here, after))[:, None, None]
        half = 0.5 / cosine * (here + after)
        half -= along[:, :, None] * axial[:, None] / (4.0 * cosine**3 * (1.0 + cosine))
    chord = (np.roll(position, -1, axis=0)[:pairs] - position[:pairs]) / spacing
    stretched = np.einsum("kic,kc->ki", half, chord) - np.array([0.0, 0.0, 1.0])
    return np.concatenate([twist, stretched], axis=1)
