"""A body as a union of balls, for what it touches: exact, and no handedness, no corners.

A ball moves on the middle line of a body and fills it: one of a sphere; along the axis of a
spherocylinder and of a long spheroid, where its radius is r(z) = b sqrt(1 - z^2/(a^2 - b^2)) up to
|z| = (a^2 - b^2)/a; over a disc in a flat spheroid. Each has a weight, the length of rod that it
counts as: its share of the line, of a disc its share of the area over the diameter d, and the
radius of the last balls, so that a sphere counts as R, however it is written.
"""

from __future__ import annotations

import numpy as np

from rodsim.blocks.surface import ON_SURFACE

ALONG = 0.25  # of the diameter: how far balls are apart on a line
DENT = 0.1  # of the diameter: how deep the dents between balls on a disc may be
MOST_RINGS = 40
SEGMENT, SPHEROID, POINTS = range(3)  # kinds of surfaces: points within a radius of a segment


def surface_numbers(shape) -> tuple[int, float, float]:
    """Return (kind, half length, radius): of a segment, or of a spheroid."""
    if shape.kind == "file":
        return POINTS, 0.0, 0.0
    if shape.kind == "spheroid" and 0.5 * shape.length != shape.radius:
        return SPHEROID, 0.5 * shape.length, shape.radius
    straight = 0.5 * shape.length - shape.radius if shape.kind == "spherocylinder" else 0.0
    return SEGMENT, straight, shape.radius


def balls_of(shape, surface, blob: str, diameter: float) -> np.ndarray:
    """Return the balls (n, 5) of a body in its own frame: x, y, z, radius, weight."""
    kind, a, b = surface_numbers(shape)
    if kind == POINTS:  # no more than the points themselves, each with its area
        area = (surface.epsilon / ON_SURFACE[blob]) ** 2
        n = surface.skin.shape[1]
        return np.column_stack([surface.skin.T, np.zeros(n), np.full(n, area / diameter)])
    if kind == SEGMENT:
        return _on_line(a, lambda z: np.full_like(z, b), diameter)
    if a > b:
        return _on_line((a * a - b * b) / a, lambda z: b * np.sqrt(1 - z * z / (a * a - b * b)),
                        diameter)  # fmt: skip
    return _on_disc(a, b, diameter)


def _on_line(half, radius, diameter):
    count = 1 + int(np.ceil(2.0 * half / (ALONG * diameter)))
    z = np.linspace(-half, half, count)
    r, weight = radius(z), np.full(count, 2.0 * half / max(count - 1, 1))
    weight[[0, -1]] *= 0.5
    weight[0] += 0.5 * r[0]
    weight[-1] += 0.5 * r[-1]
    return np.column_stack([np.zeros((count, 2)), z, r, weight])


def _on_disc(a, b, diameter):
    """Rings as far apart as their balls are; on the rim a line of them."""
    rim, edge = (b * b - a * a) / b, a * a / b
    apart = np.sqrt(8.0 * DENT * diameter * edge)
    rings = min(1 + int(np.ceil(rim / apart)), MOST_RINGS)
    found = []
    for rho in np.linspace(0.0, rim, rings):
        count = max(1, int(np.ceil(2.0 * np.pi * rho * (rings - 1) / rim)))
        angle = 2.0 * np.pi * (np.arange(count) + 0.5) / count
        share = np.pi * rim**2 / diameter * (max(rho, 0.25 * rim / (rings - 1)) / rim)
        weight = share * 2.0 / (rings - 1) / count
        if rho == rim:
            weight = 0.5 * weight + (2.0 * np.pi * rim + edge) / count
        r = a * np.sqrt(1.0 - rho**2 / (b * b - a * a))
        ball = np.full(count, rho), np.full(count, r), np.full(count, weight)
        found.append(np.column_stack([ball[0] * np.cos(angle), ball[0] * np.sin(angle),
                                      np.zeros(count), ball[1], ball[2]]))  # fmt: skip
    return np.concatenate(found)
