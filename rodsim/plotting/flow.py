"""The fluid around rods: along a line, in a plane, in a box; paths of tracers."""

from __future__ import annotations

import numpy as np

from rodsim.plotting import style

# Light colours only, so that dark stream lines and rods stay visible on them.
SPEED, PRESSURE = ("YlGnBu", 0.0, 0.72), ("RdBu_r", 0.15, 0.85)
DENSITY = 1.3  # of stream lines; matplotlib keeps 30 of them apart along a side at 1
BEND = 2.0  # radians between neighbouring lines: where directions turn by more, none is drawn
INK = "0.12"
ARROWS = 26  # along the longer side of a plane
BOX_ARROWS = 9  # along the longest side of a box


def draw_plane(axis, right, up, velocity, colour, scale, arrows=False):
    """Draw the flow in a plane on an axis; return the axis.

    right (A,), up (B,): coordinates of equal steps. velocity (A, B, 2): components to the right
    and up. colour (A, B): what the colour means; scale: a
    :class:`~rodsim.plotting.colours.Scale` of it. Stream lines, or arrows of equal length that
    show directions.
    """
    axis.pcolormesh(right, up, colour.T, cmap=scale.colours, norm=scale.norm(),
                    shading="gouraud", rasterized=True)  # fmt: skip
    scale.draw(axis.figure, axis)
    u, v = velocity[..., 0].T, velocity[..., 1].T
    if arrows:
        thin = max(1, round(max(u.shape) / ARROWS))
        cut = np.s_[thin // 2 :: thin]
        size = np.hypot(u, v)[cut, cut]
        size = np.where(size > 0.0, size, 1.0)
        axis.quiver(right[cut], up[cut], u[cut, cut] / size, v[cut, cut] / size, color=INK,
                    angles="xy", scale=0.9 * ARROWS, width=0.0025, pivot="mid")  # fmt: skip
    elif np.hypot(u, v).max() > 0.0:
        share = style.share_of_page(axis.figure)
        clear = np.ma.masked_where(knots(u, v), u)
        axis.streamplot(right, up, clear, v, color=INK, linewidth=0.7 * share,
                        arrowsize=0.8 * share, density=DENSITY * share)  # fmt: skip
    axis.set_aspect("equal")
    axis.set_xlim(right[0], right[-1])
    axis.set_ylim(up[0], up[-1])
    return axis


def knots(u, v):
    """Tell where (B, A) the direction of a flow turns by more than a line can follow.

    Around a point where a projected flow stands still, stream lines wind up or meet: each has the
    room that lies between two lines, and there the direction (u, v)/|u, v| changes by more than
    BEND.
    """
    size = np.hypot(u, v)
    direction = np.stack([u, v]) / np.where(size > 0.0, size, 1.0)
    apart = [max(1.0, n / (30.0 * DENSITY)) for n in u.shape]  # lines, in steps of the grid
    slopes = [a * np.gradient(direction, axis=k + 1) for k, a in enumerate(apart)]
    return np.sqrt(np.sum(np.square(slopes), axis=(0, 1))) > BEND


def draw_line_profile(axis, along, curves: dict, quantity, unit):
    """Draw named values (n,) along a line (n,) on an axis; return the axis."""
    for (name, values), dashes in zip(curves.items(), ("-", "--", ":", "-."), strict=False):
        axis.plot(along, values, dashes, lw=1.6, label=name)
    axis.axhline(0.0, color="0.8", lw=0.8, zorder=0)
    axis.set_xlim(along[0], along[-1])
    style.name_values(axis, quantity, unit)
    if len(curves) > 1:
        style.legend_above(axis)
    return axis


def draw_box(axis, camera, points, velocity, scale):
    """Draw arrows (n, 3) in space as a camera sees them, coloured by speed; return the axis.

    The longest arrow is as long as neighbouring points are apart; its speed is ``scale.high``.
    """
    seen, moved = camera.project(points), camera.project(velocity)
    speed = np.linalg.norm(velocity, axis=1)
    order = np.argsort(seen[:, 2])
    reach = np.ptp(points, axis=0).max() / BOX_ARROWS / (scale.high or 1.0)
    axis.quiver(*seen[order, :2].T, *moved[order, :2].T, speed[order], cmap=scale.colours,
                norm=scale.norm(), angles="xy", scale_units="xy", scale=0.6 / reach,
                width=0.003)  # fmt: skip
    return axis


def draw_paths(axis, camera, time, paths, scale):
    """Draw paths (T, P, 3) over time (T,) as lines coloured by time, a dot where each starts."""
    with style.matplotlib_needed():
        from matplotlib.collections import LineCollection
    seen = camera.project(paths)[..., :2]
    pieces = np.stack([seen[:-1], seen[1:]], axis=2).reshape(-1, 2, 2)
    values = np.repeat(0.5 * (time[1:] + time[:-1]), paths.shape[1])
    lines = LineCollection(pieces, array=values, cmap=scale.colours, norm=scale.norm(),
                           linewidths=1.2)  # fmt: skip
    axis.add_collection(lines)
    axis.scatter(*seen[0].T, s=5.0, c="0.4", linewidths=0, zorder=3)
    return axis
