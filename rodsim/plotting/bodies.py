"""Rigid bodies in pictures: the triangles of their surfaces in the light, or their outline."""

from __future__ import annotations

import numpy as np

from rodsim.plotting import style, surface

COLOUR = (0.74, 0.78, 0.83, 1.0)


def body_faces(camera, points, triangles):
    """Return the faces (F, 4, 3) that a camera sees, last corners doubled, and their colours.

    points (S, 3) of the surfaces of all bodies, triangles (F, 3), in order seen from outside.
    """
    seen = camera.project(points)[triangles]
    corners = np.concatenate([seen, seen[:, 2:]], axis=1)
    corners = corners[surface.normals(corners)[:, 2] > 0.0]
    return corners, surface.shaded(np.tile(COLOUR, (len(corners), 1)), corners)


def draw_bodies(axis, camera, points, triangles, zorder=0.6):
    """Draw bodies behind all else on a matplotlib axis; return the axis."""
    with style.matplotlib_needed():
        from matplotlib.collections import PolyCollection
    corners, colours = body_faces(camera, points, triangles)
    order = np.argsort(corners[..., 2].mean(axis=1), kind="stable")
    faces = PolyCollection(
        corners[order][..., :2], facecolors=colours[order], edgecolors=colours[order],
        linewidths=0.3, zorder=zorder,
    )  # fmt: skip
    axis.add_collection(faces, autolim=False)
    axis.update_datalim(corners[..., :2].reshape(-1, 2))
    return axis
