"""Numbers over time: kymographs along a rod, and speeds."""

from __future__ import annotations

import numpy as np

from rodsim.plotting import style


def draw_kymograph(axis, time, s, values, limits, text):
    """Draw a quantity along a rod over time, as colour, on an axis; return the axis.

    time (T,); s (S,): arc length of the rows; values (T, S); limits: lowest and highest colour;
    text: label of the colour bar. An even spacing of ``s`` is assumed.
    """
    half = 0.5 * (s[1] - s[0]) if len(s) > 1 else 0.5
    middles = 0.5 * (time[1:] + time[:-1])
    edges = np.concatenate([time[:1], middles, time[-1:]])
    rows = np.append(s - half, s[-1] + half)
    mesh = axis.pcolormesh(
        edges, rows, values.T, cmap=style.COLOURS, vmin=limits[0], vmax=limits[1], rasterized=True
    )
    axis.figure.colorbar(mesh, ax=axis, label=text, pad=0.02)
    return axis


def limits_of(values) -> tuple[float, float]:
    """Return the range of colours: from 0, or the same to both sides of it where signs differ."""
    low, high = float(np.min(values)), float(np.max(values))
    if low < 0.0 < high:
        return -max(-low, high), max(-low, high)
    return min(low, 0.0), max(high, 0.0) or 1.0


def draw_speeds(axis, time, velocity, unit, time_unit):
    """Draw how fast points move on an axis; return the axis.

    time (T,); velocity (T, N, 3). Three lines: the fastest point, max_k |u_k|; the root mean
    square over the points; the centroid, |mean u|.
    """
    speed = np.linalg.norm(velocity, axis=2)
    lines = {
        "fastest point": speed.max(axis=1),
        "root mean square": np.sqrt((speed**2).mean(axis=1)),
        "centroid": np.linalg.norm(velocity.mean(axis=1), axis=1),
    }
    for (name, values), dashes in zip(lines.items(), (":", "-", "--"), strict=True):
        axis.plot(time, values, dashes, lw=1.6, label=name)
    style.scale(axis, lines["fastest point"])
    axis.set_xlim(time[0], time[-1])
    axis.set_xlabel(style.label("time", time_unit))
    axis.set_ylabel(style.label("speed", unit))
    axis.legend(frameon=False)
    return axis
