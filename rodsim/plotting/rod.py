"""Rods at one time on an axis: surfaces seen by a camera, nearer faces over farther ones."""

from __future__ import annotations

import numpy as np

from rodsim.plotting import style, surface
from rodsim.plotting.bodies import body_faces, draw_bodies

KINDS = ("tube", "ribbon", "line")
BACK = (0.35, 0.35, 0.38, 1.0)
DARK, LIGHT = (0.1, 0.1, 0.12, 1.0), (0.95, 0.95, 0.95, 1.0)
LUMA = np.array([0.299, 0.587, 0.114])  # how bright red, green and blue look in grey


def draw_rods(axis, camera, rods, position, director, size, colours, kind="tube", bodies=None):
    """Draw rods on a matplotlib axis and return the axis.

    Parameters
    ----------
    camera : a :class:`~rodsim.plotting.camera.Camera`.
    rods : records with ``first``, ``count`` and ``closed``, as ``open_trajectory(...).rods``.
    position : (N, 3) array. director : (N, 3, 3) array, rows D^1, D^2, D^3; not used by a line.
    size : diameter of the tube or width of the ribbon, length.
    colours : for each rod one rgba (4,), or one for each of its segments (S, 4).
    kind : ``tube``: with a stripe along D^1; ``ribbon``: from -D^1 to D^1, its back side grey;
        ``line``: the centreline.
    bodies : points (S, 3) of surfaces and triangles (F, 3) between them, or None; behind lines,
        and among tubes and ribbons where they are.
    """
    pieces = []
    if bodies is not None and kind == "line":
        draw_bodies(axis, camera, *bodies)
    elif bodies is not None:
        pieces.append(body_faces(camera, *bodies))
    for rod, colour in zip(rods, colours, strict=True):
        nodes = slice(rod.first, rod.first + rod.count)
        if kind == "line":
            pieces.append(_line(camera, position[nodes], colour, rod.closed))
        else:
            triads = director[nodes]
            pieces.append(_faces(camera, position[nodes], triads, size, colour, rod.closed, kind))
    seen, painted = (np.concatenate(parts) for parts in zip(*pieces, strict=True))
    order = np.argsort(seen[..., 2].mean(axis=1), kind="stable")
    flat = seen[order][..., :2]
    axis.add_collection(_collection(kind, flat, painted[order]), autolim=False)
    axis.update_datalim(flat.reshape(-1, 2))  # what autoscale goes by
    return axis


def _line(camera, position, colour, closed):
    """Return the pieces of a centreline (S, 2, 3) and their colours (S, 4)."""
    seen = camera.project(np.concatenate([position, position[:1]]) if closed else position)
    pieces = np.stack([seen[:-1], seen[1:]], axis=1)
    return pieces, np.broadcast_to(colour, (len(pieces), 4))


def _faces(camera, position, director, size, colour, closed, kind):
    """Return the faces of a surface (F, 4, 3) and their colours in the light (F, 4)."""
    if kind == "tube":
        corners, marked = surface.tube(position, director, 0.5 * size, closed)
    else:
        corners = surface.ribbon(position, director, size, closed)
    seen = camera.project(corners)
    base = np.broadcast_to(colour, (len(seen), 4))
    painted = np.repeat(base[:, None], seen.shape[1], axis=1)
    if kind == "tube":
        stripe = np.where(base[:, :3] @ LUMA < 0.5, 1.0, 0.0)[:, None]  # light on dark, and back
        stripe = stripe * np.array(LIGHT) + (1.0 - stripe) * np.array(DARK)
        painted[marked] = np.repeat(stripe, marked.sum(axis=1), axis=0)
    else:
        painted[surface.normals(seen)[..., 2] < 0.0] = BACK
    painted = surface.shaded(painted, seen)
    return seen.reshape(-1, 4, 3), painted.reshape(-1, 4)


def _collection(kind, pieces, colours):
    with style.matplotlib_needed():
        from matplotlib.collections import LineCollection, PolyCollection
    if kind == "line":
        return LineCollection(pieces, colors=colours, linewidths=1.8, capstyle="round")
    # The thin edge in the face's own colour hides the seams of antialiasing.
    return PolyCollection(pieces, facecolors=colours, edgecolors=colours, linewidths=0.3)


def draw_tracers(axis, camera, position):
    """Draw fluid markers (P, 3) as dots beneath everything else; return the axis."""
    seen = camera.project(position)
    axis.scatter(*seen.T[:2], s=2.0, c="0.55", linewidths=0, zorder=0)
    return axis
