"""A rod as a surface of four-cornered faces: a tube with a stripe along D^1, or a ribbon."""

from __future__ import annotations

import numpy as np

AROUND = 24  # faces around a tube
STRIPE = 4  # of them white: the line along D^1 that shows the twist
SMOOTH, MOST = 150, 6000  # pieces of a rod that look smooth; of all rods that are drawn in time
CAP = np.radians([30.0, 60.0, 90.0])  # rings of the half sphere on an end
LIGHT = np.array([-0.35, 0.65, 0.67])  # towards the lamp: left, above, in front
AMBIENT = 0.45


def pieces_of(segments: int, all_segments: int) -> int:
    """Return into how many pieces each segment of a rod is cut so that it looks smooth."""
    return max(1, min(-(-SMOOTH // segments), MOST // all_segments))


def refined(position, director, pieces: int, closed=False):
    """Return positions and triads at ``pieces`` places in each segment, and the last point.

    Positions are on cubics through the points whose slopes are those of the chords around (Catmull
    and Rom); triads change linearly and are made unit vectors again.
    """
    x = np.concatenate([position, position[:1]]) if closed else position
    d = np.concatenate([director, director[:1]]) if closed else director
    slope = np.gradient(x, axis=0)
    if closed:
        slope[0] = slope[-1] = 0.5 * (x[1] - x[-2])
    h = (np.arange(pieces) / pieces)[:, None]
    h1, h2, h3 = h**2 * (3 - 2 * h), h * (1 - h) ** 2, h**2 * (h - 1)
    fine = (1 - h1) * x[:-1, None] + h1 * x[1:, None] + h2 * slope[:-1, None] + h3 * slope[1:, None]
    turned = d[:-1, None] + h[..., None] * (d[1:] - d[:-1])[:, None]
    fine, turned = fine.reshape(-1, 3), turned.reshape(-1, 3, 3)
    if not closed:
        fine, turned = np.concatenate([fine, x[-1:]]), np.concatenate([turned, d[-1:]])
    return fine, turned / np.linalg.norm(turned, axis=-1, keepdims=True)


def capped(position, director, radius: float):
    """Return positions, triads and radii with half spheres put on both ends of an open rod."""
    out, thin = radius * np.sin(CAP)[:, None], radius * np.cos(CAP)
    begin, end = position[0] - out * director[0, 2], position[-1] + out * director[-1, 2]
    triads = [director[:1].repeat(len(CAP), axis=0), director, director[-1:].repeat(len(CAP), 0)]
    radii = [thin[::-1], np.full(len(position), radius), thin]
    places = np.concatenate([begin[::-1], position, end])
    return places, np.concatenate(triads), np.concatenate(radii)


def tube(position, director, radius, closed=False):
    """Return the faces of a tube and which of them are on the stripe.

    position (M, 3), director (M, 3, 3) with rows D^1, D^2, D^3, radius a number or (M,). The
    surface is X + radius (cos(a) D^1 + sin(a) D^2). Returns corners (S, AROUND, 4, 3) for S
    segments, in order seen from outside, and a mask (S, AROUND).
    """
    angle = 2.0 * np.pi * (np.arange(AROUND + 1) - 0.5 * STRIPE) / AROUND
    across = (
        np.cos(angle)[:, None, None] * director[:, 0]
        + np.sin(angle)[:, None, None] * (director[:, 1])
    )
    radii = np.broadcast_to(radius, len(position))[:, None]
    rings = (position + radii * across).transpose(1, 0, 2)  # (M, AROUND + 1, 3)
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
