"""Error against run time, and against what was varied."""

import numpy as np

from rodsim.convergence.report import fitted_order
from rodsim.plotting import style

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
    "epsilon": "epsilon / the case's own",
    "accuracy": "accuracy of the sums",
}
DASHES = {
    "time": "-",
    "points": "--",
    "body_points": (0, (5, 1, 1, 1, 1, 1)),
    "epsilon": ":",
    "accuracy": "-.",
}
TITLES = {
    "time": "tolerance or step",
    "points": "points at fixed epsilon",
    "body_points": "points of bodies",
    "epsilon": "epsilon (sensitivity)",
    "accuracy": "accuracy of the sums",
}


@style.styled
def plot_study(study, path) -> None:
    """Draw a work-precision diagram and the errors against what was varied, to a file."""
    figure = style.new_figure(11, 4.8)
    left, right = figure.subplots(1, 2)
    draw_work_precision(left, study)
    draw_orders(right, study)
    figure.suptitle(study.case.title or "Error against run time")
    style.save(figure, path)


def draw_work_precision(axis, study):
    """Draw the largest position error over the wall time of the solve; return the axis."""
    for section in study.sections:
        for method, part in _by_method(section):
            seconds = [np.median(r.outcome.seconds) for r in part]
            errors = [r.errors.position for r in part]
            marker, colour = SPACE.get(section.axis) or MARKS[method]
            label = f"{method}, {TITLES[section.axis]}"
            axis.loglog(seconds, errors, DASHES[section.axis], marker=marker, c=colour, label=label)
        if section.axis == "time" and section.own and section.own.position > 0.0:
            axis.axhline(section.own.position, c="0.6", lw=1, zorder=0)
            axis.annotate("the reference is good to this", (0.98, section.own.position),
                          xycoords=("axes fraction", "data"), ha="right", va="bottom",
                          color="0.45", fontsize=8)  # fmt: skip
    axis.set_xlabel("wall time of the solve (s)")
    axis.set_ylabel(style.label("largest position error at the end", study.case.units.length))
    return _finish(axis)


def draw_orders(axis, study):
    """Draw the errors over step, spacing or epsilon, all over the case's own; return the axis.

    The legend tells the slope of each line, the observed order.
    """
    for section in study.sections:
        for method, part in _by_method(section):
            sizes = np.array([_relative_size(study, section, r) for r in part])
            marker, colour = SPACE.get(section.axis) or MARKS[method]
            order = fitted_order(section, method)
            label = f"{method}, {_what(section)}" + (f": slope {order:.2f}" if order else "")
            errors = [r.errors.position for r in part]
            axis.loglog(sizes, errors, DASHES[section.axis], marker=marker, c=colour, label=label)
    axis.set_xlabel(" or ".join(SIZES[section.axis] for section in study.sections))
    axis.set_ylabel(style.label("largest position error at the end", study.case.units.length))
    return _finish(axis)


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


def _what(section):
    names = {"time": "mean step", "points": "spacing", "epsilon": "epsilon", "accuracy": "accuracy"}
    return names.get(section.axis, "spacing of bodies")


def _finish(axis):
    from matplotlib.ticker import LogLocator, NullFormatter

    if axis.get_legend_handles_labels()[0]:  # there is something to see
        axis.legend(frameon=False, fontsize=8)
        for side in (axis.xaxis, axis.yaxis):
            side.set_major_locator(LogLocator(numticks=7))
            side.set_minor_formatter(NullFormatter())
    axis.grid(which="major", color="0.9")
    axis.set_axisbelow(True)
    return axis
