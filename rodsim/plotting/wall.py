"""A plane wall in pictures: a line with its far side grey, in a tilted view a piece of it."""

from __future__ import annotations

import numpy as np

FAR_SIDE, EDGE = "0.88", "0.35"


def with_wall(points: np.ndarray, camera, piece: np.ndarray | None) -> np.ndarray:
    """Return points (n, 3), and those that make room for the wall in a picture of them."""
    if piece is None or (camera.flat and "z" not in camera.flat):
        return points
    return np.concatenate([points, [[*points[0, :2], piece[0, 2]]] if camera.flat else piece])


def draw_wall(axis, camera, piece: np.ndarray | None):
    """Draw a wall behind all else on an axis that has its limits; return the axis."""
    if piece is None:
        return axis
    seen = camera.project(piece)
    if not camera.flat:
        axis.fill(*seen.T[:2], facecolor=FAR_SIDE, edgecolor=EDGE, lw=0.8, alpha=0.6, zorder=-1)
    elif "z" in camera.flat:
        mark_wall(axis, piece[0, 2], upright=camera.flat[0] == "z")
    return axis


def mark_wall(axis, height: float, upright=False):
    """Draw the wall as a line, its far side grey, on an axis with z up, or ``upright`` along x."""
    lowest = (axis.get_xlim() if upright else axis.get_ylim())[0]
    span, line = (axis.axvspan, axis.axvline) if upright else (axis.axhspan, axis.axhline)
    span(min(lowest, height), height, facecolor=FAR_SIDE, lw=0.0, zorder=0.4)
    line(height, color=EDGE, lw=1.2, zorder=0.5)
    return axis
