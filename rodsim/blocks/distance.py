"""How far points are from the surface of a body, for what is asked once.

Its compiled twin, asked thousands of times a second, is :mod:`rodsim.forces.surfaces`.
"""

from __future__ import annotations

import numpy as np

from rodsim.blocks.surface import SurfacePoints

NEWTON = 40  # steps at most; six are usual


def local(turn: np.ndarray, centre: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return points (3, n) in the frame of a body."""
    return turn.T @ (points - centre[:, None])


def distance(shape, surface: SurfacePoints, points: np.ndarray) -> np.ndarray:
    """Return how far points (3, n), in the frame of a body, are outside its surface; < 0 inside.

    Exact for spheres, spherocylinders and spheroids. A surface from a file counts as seen from its
    centre: as far as the surface point nearest in direction.
    """
    x, y, z = points
    rho = np.hypot(x, y)
    if shape.kind == "sphere":
        return np.hypot(rho, z) - shape.radius
    if shape.kind == "spherocylinder":
        straight = 0.5 * shape.length - shape.radius
        return np.hypot(rho, z - np.clip(z, -straight, straight)) - shape.radius
    if shape.kind == "spheroid":
        return _from_ellipse(0.5 * shape.length, shape.radius, abs(z), rho)
    skin = surface.skin
    radius = np.linalg.norm(skin, axis=0)
    far = np.linalg.norm(points, axis=0)
    nearest = np.argmax((skin / radius).T @ points, axis=0)
    return far - radius[nearest]


def _from_ellipse(a, b, z, rho):
    """Return the distance of (z, rho), both >= 0, from (z/a)^2 + (rho/b)^2 = 1.

    The foot of a point is (a^2 z/(t + a^2), b^2 rho/(t + b^2)) with t the largest root of
    G(t) = (a z/(t + a^2))^2 + (b rho/(t + b^2))^2 - 1, convex and falling. Newton's method from
    where one of the two terms is 1 comes to it from below.
    """
    t = np.maximum(a * z - a * a, b * rho - b * b)
    on_axis = np.minimum(t + a * a, t + b * b) <= 0.0  # as far as it is from the middle line
    t = np.where(on_axis, 0.0, t)
    for _ in range(NEWTON):
        u, v = a * z / (t + a * a), b * rho / (t + b * b)
        step = (u * u + v * v - 1.0) / (2.0 * (u * u / (t + a * a) + v * v / (t + b * b) + 1e-300))
        step = np.where(on_axis, 0.0, step)
        t = t + step
        if not (abs(step) > 1e-15 * (abs(t) + a * b)).any():
            break
    foot = a * a * z / (t + a * a), b * b * rho / (t + b * b)
    size = np.hypot(foot[0] / a**2, foot[1] / b**2) + 1e-300
    out = ((z - foot[0]) * foot[0] / a**2 + (rho - foot[1]) * foot[1] / b**2) / size
    return np.where(on_axis, -min(a, b), out)
