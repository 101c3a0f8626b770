"""The triads of rods as arrows: D^1 and D^2 at some of their points."""

from __future__ import annotations

import numpy as np

ARROWS = 16  # on each rod, about
COLOURS = {"D1": "#d62728", "D2": "#1f77b4"}
LAYERS = 2 * len(COLOURS)  # that they are drawn in: arrows, and dots
EYE_ON = 0.02  # of its length: an arrow seen shorter than this points at the viewer, and is a dot


def chosen_points(count: int) -> np.ndarray:
    """Return the numbers of the points of a rod that have arrows: its ends, and evenly between."""
    return np.unique(np.linspace(0, count - 1, min(count, ARROWS)).round().astype(int))


def draw_directors(axis, camera, rods, position, director, length):
    """Draw D^1 and D^2 as arrows of a length in space, seen by a camera; return the axis.

    position (N, 3), director (N, 3, 3) with rows D^1, D^2, D^3. D^3 is the tangent.
    """
    nodes = np.concatenate([rod.first + chosen_points(rod.count) for rod in rods])
    start = camera.project(position[nodes])[:, :2]
    for i, (name, colour) in enumerate(COLOURS.items()):
        arrow = length * camera.project(director[nodes, i])[:, :2]
        seen = np.hypot(*arrow.T) > EYE_ON * length
        axis.quiver(
            *start[seen].T, *arrow[seen].T, color=colour, angles="xy", scale_units="xy", scale=1.0,
            width=0.004, zorder=4, label=name,
        )  # fmt: skip
        axis.scatter(*start[~seen].T, s=9.0, color=colour, zorder=4, linewidths=0)
    return axis
