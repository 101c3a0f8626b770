"""A quantity of states at rest over a parameter, in the order in which they were found."""

from itertools import pairwise

import numpy as np

from rodsim.plotting import style


@style.styled
def plot_diagram(path, x, y, growing, labels, sheet=style.PLAIN) -> None:
    """Draw ``y`` over ``x`` (T,) to a file; see :func:`draw_diagram`."""
    figure = sheet.figure(6.4, 4.2)
    draw_diagram(figure.add_subplot(), x, y, growing, labels)
    sheet.save(figure, path)


def draw_diagram(axis, x, y, growing, labels):
    """Draw ``y`` over ``x``, both (T,), on a matplotlib axis; return the axis.

    States that are stable (``growing`` 0) are filled, the others open, with the number of their
    growing modes; where x goes back, line and marks change, so that both ways can be told apart.
    ``labels`` : text under the x axis, text beside the y axis.
    """
    x, y, growing = (np.asarray(values, float) for values in (x, y, growing))
    ways = _ways(x)
    for number, (part, name) in enumerate(ways):
        shade, mark = f"C{number}", "o^s"[number % 3]
        axis.plot(x[part], y[part], "-", color=shade, lw=0.9, alpha=0.6)
        stable = growing[part] == 0
        axis.plot(x[part][stable], y[part][stable], mark, color=shade, ms=5)
        if len(ways) > 1:
            axis.plot([], [], "-", marker=mark, color=shade, ms=5, label=name)
        axis.plot(x[part][~stable], y[part][~stable], mark, color=shade, ms=5, mfc="white")
    for a, b, count in zip(x, y, growing, strict=True):
        if count > 0:
            axis.annotate(f"{count:.0f}", (a, b), (4, 4), textcoords="offset points", fontsize=7)
    axis.plot([], [], "ko", ms=5, label="stable")
    if (growing != 0).any():
        axis.plot([], [], "ko", ms=5, mfc="white", label="not stable: growing modes")
    axis.set_xlabel(labels[0])
    axis.set_ylabel(labels[1])
    style.legend_above(axis)
    return axis


def _ways(x):
    """Return (slice, name) of each stretch in which x goes one way; ends belong to both."""
    side = np.sign(np.diff(x))
    turns = 1 + np.flatnonzero(side[1:] * side[:-1] < 0)
    ends = [0, *turns, len(x) - 1]
    found = []
    for begin, end in pairwise(ends):
        name = "rising" if x[end] >= x[begin] else "falling"
        found.append((slice(begin, end + 1), name))
    return found
