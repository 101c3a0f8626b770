"""What is around what is drawn: limits and ticks, a scale bar, where x, y, z point, the key."""

from __future__ import annotations

import numpy as np

from rodsim.plotting import style
from rodsim.plotting.camera import AXES, Camera
from rodsim.plotting.colours import Scale

FRAME, BAR, LINE = 0.5, 0.9, 0.18  # inches below a tilted view, of a colour bar, of a line of text
COMPASS, SCALE = 0.46, 1.1  # inches of the sides of the compass, right of it of a scale bar
SHORT = 0.7  # lengths of an arrow in the page: nearer to the middle there is no room for a letter
ROW = 1.0  # inches of a row of panels that has room for a label
TICK = 0.45, 0.3  # inches of an axis for each number below it, beside it


def set_stage(axis, camera: Camera, bounds, size=(8.0, 5.4)) -> None:
    """Give an axis of a size in inches equal scales and its limits; a tilted view has no ticks."""
    with style.matplotlib_needed():
        from matplotlib.ticker import MaxNLocator
    axis.set_aspect("equal")
    axis.set_xlim(*bounds[:, 0])
    axis.set_ylim(*bounds[:, 1])
    if not camera.flat:
        axis.set_axis_off()
    for side, inches, tick in zip((axis.xaxis, axis.yaxis), size, TICK, strict=True):
        count = int(np.clip(inches / tick, 2, 6))
        least = 1 if count == 2 else 2  # the other side has the same scale
        side.set_major_locator(MaxNLocator(count, steps=[1, 2, 2.5, 5, 10], min_n_ticks=least))


def draw_scale(axis, bounds, unit: str):
    """Draw a bar of a round length in the strip below an axis, right of the compass."""
    with style.matplotlib_needed():
        from matplotlib.transforms import ScaledTranslation, blended_transform_factory
    figure, left = axis.figure, bounds[0, 0]
    length = style.nice_length(0.35 * (bounds[1, 0] - left))
    beside = axis.transData + ScaledTranslation(COMPASS + 0.1, 0.0, figure.dpi_scale_trans)
    place = blended_transform_factory(beside, figure.dpi_scale_trans)
    bar = axis.plot([left, left + length], [0.5 * COMPASS] * 2, color="0.2", lw=2.0, clip_on=False,
                    solid_capstyle="butt", transform=place)[0]  # fmt: skip
    text = axis.annotate(
        f"{length:g} {style.pretty_unit(unit)}", (left + length, 0.5 * COMPASS), xytext=(4, 0),
        xycoords=place, textcoords="offset points", va="center", color="0.2", fontsize="small",
        annotation_clip=False,
    )  # fmt: skip
    for drawn in (bar, text):
        drawn.set_in_layout(False)  # the strip is kept free for them
    return axis


def draw_compass(figure, camera: Camera):
    """Draw the directions of x, y and z as arrows at the bottom left of a figure, below the rest.

    Returns the axis they are on.
    """
    width, height = figure.get_size_inches()
    axis = figure.add_axes((0.05 / width, 0.02 / height, COMPASS / width, COMPASS / height))
    axis.set_in_layout(False)
    axis.set_axis_off()
    axis.set_xlim(-1.5, 1.5)
    axis.set_ylim(-1.5, 1.5)
    arrows = camera.matrix[:2].T
    for name, (right, up), letter in zip(AXES, arrows, _letters(arrows), strict=True):
        arrow = {"arrowstyle": "->", "color": "0.2", "lw": 1.0, "shrinkA": 0, "shrinkB": 0}
        axis.annotate("", (right, up), xytext=(0, 0), arrowprops=arrow)
        axis.text(*letter, name, ha="center", va="center", fontsize=8, color="0.2")
    return axis


def _letters(arrows):
    """Return where the names of arrows stand: before their tips, or where that is at the middle,
    as of one that points out of the page, on that side of it which is farther from the others.
    """
    places = 1.4 * arrows
    for k, arrow in enumerate(arrows):
        length, others = np.hypot(*arrow), np.delete(places, k, axis=0)
        if 1.4 * length < SHORT:
            along = SHORT * (arrow / length if length > 1e-9 else np.full(2, -np.sqrt(0.5)))
            room = [np.hypot(*(side - others).T).min() for side in (along, -along)]
            places[k] = along if room[0] > 0.9 * room[1] else -along
    return places


def annotate(axes, camera: Camera, bounds, unit: str, key=None):
    """Say how large things are and where the axes point; return the compass, if there is one.

    axes (rows, columns) of a figure. A strip at the bottom is left for that, and for the names in
    ``key``.
    """
    figure = axes[0, 0].figure
    width, height = figure.get_size_inches()
    strip = _strip(camera, key, width) / height
    figure.get_layout_engine().set(rect=(0.0, strip, 1.0, 1.0 - strip))
    if not camera.flat:
        draw_scale(axes[-1, 0], bounds, unit)
        return draw_compass(figure, camera)
    for axis in axes[-1]:
        axis.set_xlabel(style.label(camera.flat[0], unit))
    every = height / len(axes) > ROW  # lower rows have no room for a label each
    for axis in axes[:, 0] if every else axes[len(axes) // 2, :1]:
        axis.set_ylabel(style.label(camera.flat[1], unit))
    return None


def draw_key(figure, axes, camera: Camera, key) -> None:
    """Say what colours mean: a scale of numbers beside axes, or names with their colours below."""
    if isinstance(key, Scale):
        key.draw(figure, axes)
    elif key:
        with style.matplotlib_needed():
            from matplotlib.lines import Line2D
        marks = [Line2D([], [], color=colour, lw=3.0) for colour in key.values()]
        columns = _key_columns(camera, key, figure.get_size_inches()[0])
        legend = figure.legend(
            marks, list(key), loc="lower right", ncols=columns, frameon=False, handlelength=1.2,
            columnspacing=1.0, borderaxespad=0.2,
        )  # fmt: skip
        legend.set_in_layout(False)  # its strip is kept free for it


def _key_columns(camera, key, width):
    """Return how many names fit side by side, right of compass and scale bar if there are some."""
    room = width - (0.1 if camera.flat else FRAME + SCALE)
    return max(1, min(len(key), int(room / (0.45 + style.LETTER * max(map(len, key))))))


def _strip(camera, key, width):
    """Return the inches at the bottom that compass and names take."""
    names = 0.0
    if isinstance(key, dict):
        names = LINE * -(-len(key) // _key_columns(camera, key, width)) + 0.1
    return max(names, 0.0 if camera.flat else FRAME)


def around(camera, key, sheet, title, widest):
    """Return the inches beside and below panels that are taken by what is around them."""
    width = sheet.size[0] if sheet.size else widest
    beside = (0.7 if camera.flat else 0.1) + (BAR if isinstance(key, Scale) else 0.0)
    lines = sheet.titled(title, width)
    heading = LINE * (1 + lines.count("\n")) + 0.1 if lines else 0.0
    return beside, heading + (0.45 if camera.flat else 0.05) + _strip(camera, key, width)
