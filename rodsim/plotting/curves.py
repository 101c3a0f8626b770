"""Quantities over time: one panel for each, one curve for each rod and run."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rodsim.plotting import style

DASHES = ("-", "--", "-.", ":")
MOST_IN_LEGEND = 12
FAR, MARGIN = 3.0, 0.08  # of the span of the other frames


@style.styled
def plot_curves(tables: dict, path, sheet=style.PLAIN, log=False) -> None:
    """Draw :class:`~rodsim.analysis.table.Table` of runs, by their names, over time to a file.

    The name of a single run may be an empty text. They must be in the same units. log : values on
    logarithmic axes.
    """
    quantities = list(dict.fromkeys(c.quantity for t in tables.values() for c in t.columns))
    figure = sheet.figure(6.4, 0.8 + 2.6 * len(quantities))
    axes = figure.subplots(len(quantities), 1, squeeze=False, sharex=True)[:, 0]
    told = []
    for axis, quantity in zip(axes, quantities, strict=True):
        draw_curves(axis, tables, quantity, log)
        handles, labels = axis.get_legend_handles_labels()
        notes = [k for k, handle in enumerate(handles) if handle.get_linestyle() == "None"]
        names = [label for k, label in enumerate(labels) if k not in notes]
        shown = range(len(labels))
        if names in told or len(names) > MOST_IN_LEGEND:
            shown = notes
        style.legend_above(axis, [handles[k] for k in shown], [labels[k] for k in shown])
        told.append(names)
    table = next(iter(tables.values()))
    axes[-1].set_xlabel(style.label("time", table.time_unit))
    sheet.save(figure, path)


def draw_curves(axis, tables: dict, quantity: str, log=False):
    """Draw one quantity of all tables on a matplotlib axis; return the axis.

    Colours tell runs apart, and rods where there is one run; dashes the other of the two.
    """
    several, drawn = len(tables) > 1, []
    for run, (name, table) in enumerate(tables.items()):
        chosen = [k for k, column in enumerate(table.columns) if column.quantity == quantity]
        for number, k in enumerate(chosen):
            colour = f"C{(run if several else number) % 10}"
            dash = DASHES[(number if len(chosen) > 1 else run) % len(DASHES)]
            of = table.columns[k].of if len(chosen) > 1 else ""
            label = " ".join(filter(None, (name, of))) or None
            axis.plot(table.time, table.values[:, k], dash, color=colour, lw=1.5, label=label)
            unit = table.columns[k].unit
            drawn.append((table.time, table.values[:, k]))
    begin, end = (edge(time[k] for time, _ in drawn) for edge, k in ((min, 0), (max, -1)))
    if end > begin:
        axis.set_xlim(begin, end)
    if log:
        style.log_scale(axis, [values for _, values in drawn])
    else:
        _leave_out_the_jolt(axis, [values for _, values in drawn])
    style.name_values(axis, quantity.replace("_", " "), unit)
    return axis


def _leave_out_the_jolt(axis, curves):
    """Scale an axis by all frames but the first, where that one is far off the others.

    A rod seldom starts at rest, and what it does in its first moment would hide all the rest.
    """
    first = np.array([values[0] for values in curves])
    later = np.concatenate([values[1:] for values in curves])
    if not np.isfinite(first).all() or np.isfinite(later).sum() < 2:
        return
    low, high = np.nanmin(later), np.nanmax(later)
    span = (high - low) or abs(high)
    if not (first > high + FAR * span).any() and not (first < low - FAR * span).any():
        return
    axis.set_ylim(low - MARGIN * span, high + MARGIN * span)
    values = ", ".join(dict.fromkeys(f"{value:.3g}" for value in first))
    text = f"at the start: {values}" if len(first) < 4 else "the start is off the scale"
    axis.plot([], [], " ", label=text)  # a line of the legend, which lies on no curve


def run_names(paths) -> list[str]:
    """Return short names of files that tell them apart: what their paths do not have in common.

    >>> run_names(["sweep/b=1/out.h5", "sweep/b=2/out.h5"])
    ['b=1', 'b=2']
    """
    if len(paths) == 1:
        return [""]
    parts = [[*Path(path).parent.parts, Path(path).stem] for path in paths]
    for place in (0, -1):
        while all(len(part) > 1 for part in parts) and len({part[place] for part in parts}) == 1:
            for part in parts:
                part.pop(place)
    return ["/".join(part) for part in parts]
