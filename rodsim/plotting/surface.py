"""A rod as a surface of four-cornered faces: a tube with a stripe along D^1, or a ribbon."""

from __future__ import annotations

import numpy as np

AROUND = 16  # faces around a tube
STRIPE = 3  # of them dark: the line along D^1 that shows the twist
LIGHT = np.array([-0.35, 0.65, 0.67])  # towards the lamp: left, above, in front
AMBIENT = 0.45


def tube(position, director, radius, closed=False):
    """Return the faces of a tube and which of them are on the stripe.

    position (M, 3), director (M, 3, 3) with rows D^1, D^2, D^3. The surface is X + radius
    (cos(a) D^1 + sin(a) D^2). Returns corners (S, AROUND, 4, 3) for S segments and a mask
    (S, AROUND).
    """
    angle = 2.0 * np.pi * (np.arange(AROUND + 1) - 0.5 * STRIPE) / AROUND
    across = (
        np.cos(angle)[:, None, None] * director[:, 0]
        + np.sin(angle)[:, None, None] * (director[:, 1])
    )
    rings = (position + radius * across).transpose(1, 0, 2)  # (M, AROUND + 1, 3)
    stripe = np.zeros((len(position) - (not closed), AROUND), dtype=bool)
    stripe[:, :STRIPE] = True
    return _faces(rings, closed), stripe


def ribbon(position, director, width, closed=False):
    """Return the faces of a ribbon from X - width/2 D^1 to X + width/2 D^1, (S, 1, 4, 3)."""
    edge = 0.5 * width * director[:, 0]
    return _faces(np.stack([position - edge, position + edge], axis=1), closed)


def _faces(rings, closed):
    """Join neighbouring rows of points (M, A, 3) by faces, corners in order, (S, A - 1, 4, 3)."""
    if closed:
        rings = np.concatenate([rings, rings[:1]])
    here, after = rings[:-1], rings[1:]
    return np.stack([here[:, :-1], here[:, 1:], after[:, 1:], after[:, :-1]], axis=2)


def normals(corners: np.ndarray) -> np.ndarray:
    """Return the unit normals (..., 3) of faces (..., 4, 3), by their diagonals."""
    first, second = corners[..., 2, :] - corners[..., 0, :], corners[..., 3, :] - corners[..., 1, :]
    normal = np.cross(first, second)
    size = np.linalg.norm(normal, axis=-1, keepdims=True)
    return normal / np.where(size > 0.0, size, 1.0)


def shaded(colour: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Return colours (F, 4) in the light that falls on faces with corners ``seen`` (F, 4, 3).

    ``seen`` is in the camera's frame; both sides of a face are lit (Lambert's law).
    """
    light = LIGHT / np.linalg.norm(LIGHT)
    normal = normals(seen)
    normal = np.where(normal[..., 2:] < 0.0, -normal, normal)
    bright = AMBIENT + (1.0 - AMBIENT) * np.clip(normal @ light, 0.0, 1.0)
    out = np.array(colour, dtype=float)
    out[..., :3] *= bright[..., None]
    return out
