"""The fluid around rods: along a line, in a plane, in a box; paths of tracers."""

from __future__ import annotations

import numpy as np

from rodsim.plotting import style

# Light colours only, so that dark stream lines and rods stay visible on them.
SPEED, PRESSURE = ("YlGnBu", 0.0, 0.72), ("viridis", 0.3, 1.0)
INK = "0.12"
ARROWS = 26  # along the longer side of a plane
BOX_ARROWS = 9  # along the longest side of a box


def light_map(name: str, low: float, high: float):
    """Return part of one of matplotlib's colour maps as a colour map."""
    with style.matplotlib_needed():
        from matplotlib.colors import ListedColormap
    return ListedColormap(style.colour_map(name)(np.linspace(low, high, 256)))


def draw_plane(axis, right, up, velocity, colour, text, colours, limits=None, arrows=False):
    """Draw the flow in a plane on an axis; return the axis.

    right (A,), up (B,): coordinates of equal steps. velocity (A, B, 2): components to the right
    and up. colour (A, B): what the colour means, ``text`` its label, ``colours`` a colour map,
    ``limits`` its ends. Stream lines, or arrows of equal length that show directions.
    """
    low, high = limits or (colour.min(), colour.max())
    mesh = axis.pcolormesh(
        right, up, colour.T, cmap=colours, vmin=low, vmax=high, shading="gouraud", rasterized=True
    )
    below, above = colour.min() < low, colour.max() > high
    extend = {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[below, above]
    axis.figure.colorbar(mesh, ax=axis, label=text, extend=extend, pad=0.02, shrink=0.8)
    u, v = velocity[..., 0].T, velocity[..., 1].T
    if arrows:
        thin = max(1, round(max(u.shape) / ARROWS))
        cut = np.s_[thin // 2 :: thin]
        size = np.hypot(u, v)[cut, cut]
        size = np.where(size > 0.0, size, 1.0)
        axis.quiver(right[cut], up[cut], u[cut, cut] / size, v[cut, cut] / size, color=INK,
                    angles="xy", scale=0.9 * ARROWS, width=0.0025, pivot="mid")  # fmt: skip
    elif np.hypot(u, v).max() > 0.0:
        axis.streamplot(right, up, u, v, color=INK, linewidth=0.7, arrowsize=0.8, density=1.3)
    axis.set_aspect("equal")
    axis.set_xlim(right[0], right[-1])
    axis.set_ylim(up[0], up[-1])
    return axis


def draw_line_profile(axis, along, curves: dict, text):
    """Draw named values (n,) along a line (n,) on an axis; return the axis."""
    for (name, values), dashes in zip(curves.items(), ("-", "--", ":", "-."), strict=False):
        axis.plot(along, values, dashes, lw=1.6, label=name)
    axis.axhline(0.0, color="0.8", lw=0.8, zorder=0)
    axis.set_xlim(along[0], along[-1])
    axis.set_ylabel(text)
    if len(curves) > 1:
        axis.legend(frameon=False, ncols=len(curves))
    return axis


def draw_box(axis, camera, points, velocity, colours, top):
    """Draw arrows (n, 3) in space as a camera sees them, coloured by speed; return the axis.

    The longest arrow is as long as neighbouring points are apart; its speed is ``top``.
    """
    seen, moved = camera.project(points), camera.project(velocity)
    speed = np.linalg.norm(velocity, axis=1)
    order = np.argsort(seen[:, 2])
    reach = np.ptp(points, axis=0).max() / BOX_ARROWS / (top or 1.0)
    axis.quiver(*seen[order, :2].T, *moved[order, :2].T, speed[order], cmap=colours, angles="xy",
                scale_units="xy", scale=0.6 / reach, width=0.003, clim=(0.0, top))  # fmt: skip
    return axis


def draw_paths(axis, camera, time, paths, colours):
    """Draw paths (T, P, 3) over time (T,) as lines coloured by time, a dot where each starts."""
    with style.matplotlib_needed():
        from matplotlib.collections import LineCollection
    seen = camera.project(paths)[..., :2]
    pieces = np.stack([seen[:-1], seen[1:]], axis=2).reshape(-1, 2, 2)
    values = np.repeat(0.5 * (time[1:] + time[:-1]), paths.shape[1])
    lines = LineCollection(pieces, array=values, cmap=colours, linewidths=1.2)
    lines.set_clim(time[0], time[-1])
    axis.add_collection(lines)
    axis.scatter(*seen[0].T, s=5.0, c="0.4", linewidths=0, zorder=3)
    return axis
