"""Error against run time, and against what was varied."""

import textwrap

import numpy as np

from rodsim.case.methods import ADAPTIVE
from rodsim.convergence.outcome import pairs
from rodsim.convergence.report import fitted_order
from rodsim.plotting import style

WIDE = 1.5  # times as wide as high: the three panels then stand side by side
NUMBERS, NUMBER = 9, 0.33  # on a side at most; inches that each takes
FRAME = 0.7  # inches of a panel beside its axes
FEW_DECADES = 2.6  # on fewer, ticks stand at 2 and 5 as well
MARKS = {"rkc": ("o", "#0b4f8a"), "euler": ("s", "#d1660f"), "rk4": ("^", "#3a7d2c")}
SPACE = {
    "points": ("D", "#8a3b7a"),
    "body_points": ("P", "#2a7a7a"),
    "epsilon": ("v", "0.45"),
    "accuracy": ("p", "#a08000"),
}
SIZES = {
    "time": "mean step / run",
    "points": "spacing / length",
    "body_points": "(points of bodies)^(-1/2)",
    "epsilon": "epsilon / its own",
    "accuracy": "accuracy of the sums",
}
DASHES = {
    "time": "-",
    "points": "--",
    "body_points": (0, (5, 1, 1, 1, 1, 1)),
    "epsilon": ":",
    "accuracy": "-.",
}
ADAPTIVE_TITLE = "tolerance"
TITLES = {
    "time": "step",
    "points": "points at fixed epsilon",
    "body_points": "points of bodies",
    "epsilon": "epsilon (sensitivity)",
    "accuracy": "accuracy of the sums",
}


@style.styled
def plot_study(study, path, sheet=style.PLAIN) -> None:
    """Draw the errors against run time, evaluations, and what was varied, to a file."""
    figure = sheet.figure(15, 4.8, study.case.title or "Error against run time")
    width, height = figure.get_size_inches()
    abreast = width > WIDE * height
    rows, columns = (1, 3) if abreast else (3, 1)
    axes = figure.subplots(rows, columns, sharey=True)
    for axis, draw in zip(axes, (draw_run_time, draw_evaluations, draw_orders), strict=True):
        draw(axis, study, legend=False)
    _legend(figure, axes[-1], width)
    error = style.label("largest position error at the end", study.case.units.length)
    for axis in axes[:1] if abreast else axes:
        axis.set_ylabel(error)
    for axis in axes:
        _fit(axis, width / columns, height / rows)
    sheet.save(figure, path)


def _legend(figure, axis, width):
    """Put one legend for all panels below them, in as many columns as there is room for."""
    handles, labels = axis.get_legend_handles_labels()
    if labels:
        wide = style.HANDLE + style.LETTER * max(map(len, labels))
        columns = max(1, min(len(labels), int(width / wide)))
        figure.legend(handles, labels, frameon=False, loc="outside lower center", ncols=columns)


def draw_run_time(axis, study, legend=True):
    """Draw the largest position error over the wall time of the solve; return the axis."""
    _draw_cost(axis, study, lambda outcome: outcome.best)
    axis.set_xlabel("wall time of the solve (s)")
    return _finish(axis, legend)


def draw_evaluations(axis, study, legend=True):
    """Draw the largest position error over the evaluations of the sums; return the axis.

    Those with other numbers of points count by their pairs, over those of the case itself. No
    other work on the machine changes them, and any machine has the same.
    """
    own = pairs(study.scene)
    _draw_cost(axis, study, lambda outcome: outcome.evaluations * outcome.pairs / own)
    axis.set_xlabel("evaluations of the case's own sums")
    return _finish(axis, legend)


def _draw_cost(axis, study, cost):
    for section in study.sections:
        for method, part in _by_method(section):
            costs = [cost(r.outcome) for r in part]
            errors = [r.errors.position for r in part]
            marker, colour = SPACE.get(section.axis) or MARKS[method]
            label = _label(section, method)
            axis.loglog(costs, errors, DASHES[section.axis], marker=marker, c=colour, label=label)
            _hollow(axis, costs, errors, part, marker, colour)
        if section.axis == "time" and section.own and section.own.position > 0.0:
            axis.axhline(section.own.position, c="0.6", lw=1, zorder=0)
            axis.annotate("the reference is good to this", (0.98, section.own.position),
                          xycoords=("axes fraction", "data"), ha="right", va="bottom",
                          color="0.45", fontsize=8)  # fmt: skip


def draw_orders(axis, study, legend=True):
    """Draw the errors over step, spacing or epsilon, all over the case's own; return the axis.

    The legend tells the slope of each line, the observed order.
    """
    for section in study.sections:
        for method, part in _by_method(section):
            sizes = np.array([_relative_size(study, section, r) for r in part])
            marker, colour = SPACE.get(section.axis) or MARKS[method]
            label = _label(section, method)
            errors = [r.errors.position for r in part]
            axis.loglog(sizes, errors, DASHES[section.axis], marker=marker, c=colour, label=label)
            _hollow(axis, sizes, errors, part, marker, colour)
    axis.set_xlabel(" or ".join(SIZES[section.axis] for section in study.sections))
    return _finish(axis, legend)


def _hollow(axis, x, errors, part, marker, colour):
    """Mark the rows that are not run to the end."""
    chosen = [k for k, r in enumerate(part) if r.row.part < 1.0]
    if chosen:
        axis.plot(np.take(x, chosen), np.take(errors, chosen), marker, mfc="white", c=colour)


def _by_method(section):
    """Yield (method, rows with errors above zero, in order of value)."""
    done = [r for r in section.results if r.errors and r.errors.position > 0.0]
    for method in dict.fromkeys(r.row.method for r in done):
        chosen = [r for r in done if r.row.method == method]
        yield method, sorted(chosen, key=lambda r: r.row.value)


def _relative_size(study, section, result):
    if section.axis == "epsilon":
        return result.row.value / study.scene.epsilon
    if section.axis == "accuracy":
        return result.row.value
    if section.axis == "points":
        return 1.0 / result.outcome.scene.rods.segments.sum()
    if section.axis == "body_points":
        return result.row.value**-0.5
    return 1.0 / result.outcome.steps


def _label(section, method):
    """Return what a line is: the method, what varies, the order seen."""
    varied = ADAPTIVE_TITLE if section.axis == "time" and method in ADAPTIVE else None
    order = fitted_order(section, method)
    seen = f": order {order:.2f}" if order else ""
    return f"{method}, {varied or TITLES[section.axis]}{seen}"


def _finish(axis, legend=True):
    if axis.get_legend_handles_labels()[0]:  # there is something to see
        if any(line.get_mfc() == "white" for line in axis.lines):
            axis.plot([], [], "o", mfc="white", c="0.4", label="only the first part was run")
        if legend:
            axis.legend(frameon=False, fontsize=8)
    axis.grid(which="major", color="0.9")
    axis.set_axisbelow(True)
    return axis


def _fit(axis, width, height):
    """Lay a panel out for its width and height in inches: ticks and names."""
    axis.set_xlabel(_wrapped(axis.get_xlabel(), width))
    axis.set_ylabel(_wrapped(axis.get_ylabel(), height))
    if axis.get_legend_handles_labels()[0]:
        for side, limits, room in (
            (axis.xaxis, axis.get_xlim(), width),
            (axis.yaxis, axis.get_ylim(), height),
        ):
            _readable(side, *limits, int(min(NUMBERS, (room - FRAME) / NUMBER)))


def _wrapped(text, room):
    """Return the name of a side in lines that fit so many inches."""
    return textwrap.fill(text, max(8, int(style.CHARACTERS * (room - FRAME))))


def _readable(side, low, high, most=NUMBERS):
    """Give a logarithmic side up to ``most`` numbers: powers of ten, or between them 2 and 5."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

    few = np.log10(high / low) < min(FEW_DECADES, most / 3.0)
    side.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if few else (1.0,), numticks=most))
    if not few:  # each small tick of many decades takes its time
        side.set_minor_locator(NullLocator())
    side.set_major_formatter(FuncFormatter(lambda value, place: number_text(value)))
    side.set_minor_formatter(NullFormatter())


def number_text(value: float) -> str:
    """Return a tick's number as it is written: plain from 0.001 to 50 000, else by powers of ten.

    >>> number_text(0.02), number_text(1e-6), number_text(2e5)
    ('0.02', '10⁻⁶', '2×10⁵')
    """
    if 1e-3 <= value < 1e5:
        return f"{value:.6g}"
    power = int(np.floor(np.log10(value) + 1e-9))
    factor = round(value / 10.0**power)
    times = "" if factor == 1 else f"{factor}×"
    return f"{times}{style.power_of_ten(power)}"
