"""One column of a table against another."""

from rodsim.plotting import style

MARKERS = "osD^vP*X<>"


def plot_columns(path, x, y, groups, labels) -> None:
    """Draw ``y`` over ``x``, both lists of T entries, to a file; see :func:`draw_columns`."""
    figure = style.new_figure(6.4, 4.2)
    draw_columns(figure.add_subplot(), x, y, groups, labels)
    style.save(figure, path)


def draw_columns(axis, x, y, groups, labels):
    """Draw ``y`` over ``x`` on a matplotlib axis, one line for each group; return the axis.

    ``groups`` : T texts, the name of each entry's line, ``""`` where there is only one.
    ``labels`` : text under the x axis, text beside the y axis.
    """
    names = list(dict.fromkeys(groups))
    for number, name in enumerate(names):
        points = [(a, b) for a, b, group in zip(x, y, groups, strict=True) if group == name]
        if all(isinstance(a, int | float) for a, _ in points):
            points.sort()
        shade = f"C{number}" if len(names) <= 10 else None
        axis.plot(
            *zip(*points, strict=True), "-", marker=MARKERS[number % len(MARKERS)], ms=5, lw=1.2,
            color=shade, label=name,
        )  # fmt: skip
    axis.set_xlabel(labels[0])
    axis.set_ylabel(labels[1])
    if any(names):
        axis.legend(frameon=False)
    return axis
