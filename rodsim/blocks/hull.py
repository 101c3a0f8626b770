"""The surface of a body as triangles between its points: their convex hull, point by point."""

from __future__ import annotations

import numpy as np

THIN = 1e-9  # of the extent: a point this close to a face lies in it


def triangles(surface) -> np.ndarray:
    """Return the corners (F, 3) of triangles over a surface, in order as seen from outside.

    Built shapes are convex: the hull of their points. What comes from a file is seen from its
    centre: the hull of the directions of its points.
    """
    skin = surface.skin
    if surface.normals is None:
        skin = skin / np.linalg.norm(skin, axis=0)
    return hull(skin.T)


def hull(points: np.ndarray) -> np.ndarray:
    """Return the triangles (F, 3) of the convex hull of points (n, 3).

    Each point takes away the faces that it sees, and is joined to the edges of the hole.
    """
    extent = np.ptp(points, axis=0).max()
    start = _tetrahedron(points)
    inside = points[start].mean(axis=0)
    faces = np.array([start[[1, 2, 3]], start[[0, 3, 2]], start[[0, 1, 3]], start[[0, 2, 1]]])
    faces, planes = _outwards(points, faces, inside)
    for k in np.setdiff1d(np.arange(len(points)), start):
        sees = planes[:, :3] @ points[k] - planes[:, 3] > THIN * extent
        if not sees.any():
            continue
        rim = _rim(faces[sees])
        fan = np.column_stack([rim, np.full(len(rim), k)])
        fan, own = _outwards(points, fan, inside)
        faces = np.concatenate([faces[~sees], fan])
        planes = np.concatenate([planes[~sees], own])
    return faces


def _tetrahedron(points):
    """Return four points that span space, each the farthest from those before."""
    first = int(points[:, 0].argmin())
    arms = points - points[first]
    second = int((arms**2).sum(axis=1).argmax())
    across = np.cross(arms, arms[second])
    third = int((across**2).sum(axis=1).argmax())
    fourth = int(np.abs(arms @ across[third]).argmax())
    return np.array([first, second, third, fourth])


def _outwards(points, faces, inside):
    """Return faces turned so that a point is behind them all, and their planes (F, 4)."""
    a, b, c = (points[faces[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    level = (normal * a).sum(axis=1)
    behind = normal @ inside > level
    faces = np.where(behind[:, None], faces[:, ::-1], faces)
    sign = np.where(behind, -1.0, 1.0)
    return faces, np.column_stack([sign[:, None] * normal, sign * level])


def _rim(faces):
    """Return the edges (E, 2) that only one of some faces has."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    base = int(edges.max()) + 1
    there, back = edges @ (base, 1), edges @ (1, base)
    return edges[~np.isin(there, back)]
