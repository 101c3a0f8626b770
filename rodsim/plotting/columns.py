"""One column of a table against another, or against two as a map."""

from __future__ import annotations

import numpy as np

from rodsim.errors import UsageError
from rodsim.plotting import colours, style

MARKERS = "osD^vP*X<>"
DECADES = 2.0  # that positive numbers span where an axis is logarithmic
MOST_TICKS = 9  # of a map, at its values


@style.styled
def plot_columns(path, x, y, groups, labels, log="", sheet=style.PLAIN) -> None:
    """Draw ``y`` over ``x``, both lists of T entries, to a file; see :func:`draw_columns`."""
    figure = sheet.figure(6.4, 4.2)
    draw_columns(figure.add_subplot(), x, y, groups, labels, log)
    sheet.save(figure, path)


@style.styled
def plot_map(path, x, y, z, labels, quantity, log="", sheet=style.PLAIN) -> None:
    """Draw ``z`` (Y, X) over ``x`` (X,) and ``y`` (Y,) to a file; see :func:`draw_map`."""
    figure = sheet.figure(6.0, 4.6)
    draw_map(figure.add_subplot(), x, y, z, labels, quantity, log)
    sheet.save(figure, path)


def draw_columns(axis, x, y, groups, labels, log=""):
    """Draw ``y`` over ``x`` on a matplotlib axis, one line for each group; return the axis.

    ``groups`` : T texts, the name of each entry's line, ``""`` where there is only one.
    ``labels`` : text under the x axis, text beside the y axis. ``log`` : see :func:`set_log`.
    """
    names = list(dict.fromkeys(groups))
    shades = colours.of_rods(names)
    for number, name in enumerate(names):
        points = [(a, b) for a, b, group in zip(x, y, groups, strict=True) if group == name]
        if all(isinstance(a, int | float) for a, _ in points):
            points.sort()
        axis.plot(
            *zip(*points, strict=True), "-", marker=MARKERS[number % len(MARKERS)], ms=5, lw=1.2,
            color=shades[name], label=name,
        )  # fmt: skip
    set_log(axis, x, y, log)
    axis.set_xlabel(labels[0])
    axis.set_ylabel(labels[1])
    if any(names):
        style.legend_above(axis)
    return axis


def draw_map(axis, x, y, z, labels, quantity, log=""):
    """Draw numbers ``z`` (Y, X) as colours over ``x`` (X,) and ``y`` (Y,); return the axis.

    Each has a cell about its place, none where it is NaN. ``labels`` : of the axes. ``quantity`` :
    (name, unit) of ``z``. ``log`` : see :func:`set_log`.
    """
    z = np.asarray(z, float)
    scale = colours.scale_of([z[np.isfinite(z)][None]], *quantity, paper=False)
    set_log(axis, x, y, log)
    edges = [_edges(values, side.get_scale() == "log")
             for values, side in ((x, axis.xaxis), (y, axis.yaxis))]  # fmt: skip
    axis.pcolormesh(*edges, np.ma.masked_invalid(z), cmap=scale.colours, norm=scale.norm())
    axis.set_facecolor("0.9")  # of what there is no run of
    for values, side in ((x, axis.xaxis), (y, axis.yaxis)):
        if len(values) <= MOST_TICKS:
            side.set_ticks(values, [f"{value:.4g}" for value in values])
            side.set_ticks([], minor=True)
    axis.set_xlabel(labels[0])
    axis.set_ylabel(labels[1])
    scale.draw(axis.figure, axis)
    return axis


def set_log(axis, x, y, log="") -> None:
    """Make axes logarithmic: those named in ``log``, "x", "y", "xy" or "none".

    Without a name, those of positive numbers that span two decades or more, and x or y of a map
    whose values follow each other by one ratio.
    """
    for name, values in (("x", x), ("y", y)):
        numbers = all(isinstance(value, int | float | np.number) for value in values)
        known = [v for v in values if numbers and v == v]
        positive = bool(known) and min(known) > 0.0
        if name in log.replace("none", "") and not positive:
            raise UsageError(f"--log {log}: {name} has values that are not above zero")
        wide = positive and (max(known) >= 10.0**DECADES * min(known) or _geometric(known))
        if name in log.replace("none", "") or (not log and wide):
            getattr(axis, f"set_{name}scale")("log")


def _geometric(values):
    """Tell whether three values or more, in order, follow each other by one ratio."""
    ratios = np.array(values[1:]) / values[:-1]
    return len(ratios) > 1 and ratios[0] > 1.0 and np.ptp(ratios) < 1e-9 * ratios[0]


def _edges(values, log):
    """Return the edges of cells about values: half-way between them, on a logarithmic axis too."""
    places = np.log(values) if log else np.asarray(values, float)
    middles = 0.5 * (places[1:] + places[:-1])
    ends = [2.0 * places[0] - middles[0]], [2.0 * places[-1] - middles[-1]]
    edges = np.concatenate([ends[0], middles, ends[1]])
    return np.exp(edges) if log else edges
