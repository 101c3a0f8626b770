"""Numbers over time: kymographs along a rod, and speeds."""

from __future__ import annotations

import numpy as np

from rodsim.plotting import style


def draw_kymograph(axis, time, s, values, scale):
    """Draw a quantity along a rod over time, as colour, on an axis; return the axis.

    time (T,); s (S,): arc length of the rows; values (T, S); scale: what colours mean, a
    :class:`~rodsim.plotting.colours.Scale`. An even spacing of ``s`` is assumed.
    """
    half = 0.5 * (s[1] - s[0]) if len(s) > 1 else 0.5
    middles = 0.5 * (time[1:] + time[:-1])
    edges = np.concatenate([time[:1], middles, time[-1:]])
    rows = np.append(s - half, s[-1] + half)
    axis.pcolormesh(
        edges, rows, values.T, cmap=scale.colours, vmin=scale.low, vmax=scale.high, rasterized=True
    )
    return axis


def draw_speeds(axis, time, velocity, unit, time_unit, log=False):
    """Draw how fast points move on an axis; return the axis.

    time (T,); velocity (T, N, 3). Three lines: the fastest point, max_k |u_k|; the root mean
    square over the points; the centroid, |mean u|. log : a logarithmic scale, also without a peak.
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
    if log:
        style.log_scale(axis, lines.values())
    axis.set_xlim(time[0], time[-1])
    axis.set_xlabel(style.label("time", time_unit))
    style.name_values(axis, "speed", unit)
    style.legend_above(axis)
    return axis
