"""Rods at one time on an axis: surfaces seen by a camera, nearer faces over farther ones."""

from __future__ import annotations

import numpy as np

from rodsim.plotting import style, surface
from rodsim.plotting.bodies import body_faces, draw_bodies

KINDS = ("tube", "ribbon", "line")
STRIPE = (1.0, 1.0, 1.0, 1.0)  # the same on every tube: colours of rods are none too light for it
BACK = 0.55  # of a ribbon's colour, on its back


def draw_rods(axis, camera, rods, position, director, size, colours, kind="tube", bodies=None):
    """Draw rods on a matplotlib axis and return the axis.

    Parameters
    ----------
    camera : a :class:`~rodsim.plotting.camera.Camera`.
    rods : records with ``first``, ``count`` and ``closed``, as ``open_trajectory(...).rods``.
    position : (N, 3) array. director : (N, 3, 3) array, rows D^1, D^2, D^3; not used by a line.
    size : diameter of the tube or width of the ribbon, length.
    colours : for each rod one rgba (4,), or one for each of its segments (S, 4).
    kind : ``tube``: with round ends and a white stripe along D^1; ``ribbon``: from -D^1 to D^1, its
        back darker; ``line``: the centreline. Tubes and ribbons are smooth between the points.
    bodies : points (S, 3) of surfaces and triangles (F, 3) between them, or None; behind lines,
        and among tubes and ribbons where they are.
    """
    if kind == "line":
        if bodies is not None:
            draw_bodies(axis, camera, *bodies)
        return _draw_lines(axis, camera, rods, position, colours)
    pieces, segments = [], sum(rod.count - (not rod.closed) for rod in rods)
    if bodies is not None:
        pieces.append(body_faces(camera, *bodies))
    for rod, colour in zip(rods, colours, strict=True):
        nodes = slice(rod.first, rod.first + rod.count)
        cut = surface.pieces_of(rod.count - (not rod.closed), segments)
        fine = surface.refined(position[nodes], director[nodes], cut, rod.closed)
        painted = np.asarray(colour)
        painted = painted.repeat(cut, axis=0) if painted.ndim == 2 else painted
        draw = _tube if kind == "tube" else _ribbon
        pieces.append(draw(camera, *fine, size, painted, rod.closed))
    seen, painted = (np.concatenate(parts) for parts in zip(*pieces, strict=True))
    order = np.argsort(seen[..., 2].mean(axis=1), kind="stable")
    flat = seen[order][..., :2]
    with style.matplotlib_needed():
        from matplotlib.collections import PolyCollection
    # The thin edge in the face's own colour hides the seams of antialiasing.
    faces = PolyCollection(flat, facecolors=painted[order], edgecolors=painted[order],
                           linewidths=0.3)  # fmt: skip
    return _add(axis, faces, flat.reshape(-1, 2))


def _draw_lines(axis, camera, rods, position, colours):
    """Draw centrelines, each in one go where it has one colour, nearer over farther ones."""
    with style.matplotlib_needed():
        from matplotlib.collections import LineCollection
    lines, painted = [], []
    for rod, colour in zip(rods, colours, strict=True):
        nodes = position[rod.first : rod.first + rod.count]
        seen = camera.project(np.concatenate([nodes, nodes[:1]]) if rod.closed else nodes)
        if np.ndim(colour) == 1:
            lines.append(seen)
            painted.append(colour)
        else:
            lines += [*np.stack([seen[:-1], seen[1:]], axis=1)]
            painted += [*colour]
    order = np.argsort([line[:, 2].mean() for line in lines], kind="stable")
    flat = [lines[k][:, :2] for k in order]
    drawn = LineCollection(flat, colors=[painted[k] for k in order], linewidths=1.8,
                           capstyle="round", joinstyle="round")  # fmt: skip
    return _add(axis, drawn, np.concatenate(flat))


def _add(axis, collection, corners):
    """Add a collection to an axis; its corners are what autoscale goes by."""
    axis.add_collection(collection, autolim=False)
    axis.update_datalim(corners)
    return axis


def _tube(camera, position, director, size, colour, closed):
    """Return the faces of a tube that a camera sees (F, 4, 3), their colours in the light."""
    radius = 0.5 * size
    if not closed:
        position, director, radius = surface.capped(position, director, radius)
        if colour.ndim == 2:
            ends = len(surface.CAP)
            colour = np.concatenate(
                [colour[:1].repeat(ends, 0), colour, colour[-1:].repeat(ends, 0)]
            )
    corners, stripe = surface.tube(position, director, radius, closed)
    seen = camera.project(corners)
    base = np.broadcast_to(colour, (len(seen), 4))
    painted = np.where(stripe[..., None], np.array(STRIPE), base[:, None])
    towards = surface.normals(seen)[..., 2] > 0.0  # the tube is closed: its inside is not seen
    seen, painted = seen[towards], painted[towards]
    return seen, surface.shaded(painted, seen)


def _ribbon(camera, position, director, size, colour, closed):
    """Return the faces of a ribbon (F, 4, 3) and their colours in the light, darker on the back."""
    seen = camera.project(surface.ribbon(position, director, size, closed))[:, 0]
    painted = np.array(np.broadcast_to(colour, (len(seen), 4)))
    painted[surface.normals(seen)[..., 2] < 0.0, :3] *= BACK
    return seen, surface.shaded(painted, seen)


def draw_tracers(axis, camera, position):
    """Draw fluid markers (P, 3) as dots beneath everything else; return the axis."""
    seen = camera.project(position)
    axis.scatter(*seen.T[:2], s=2.0, c="0.55", linewidths=0, zorder=0)
    return axis
