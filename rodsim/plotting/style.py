"""What all pictures share: units as people write them, fonts, legends, sizes, saving."""

from __future__ import annotations

import textwrap
import warnings
from contextlib import contextmanager
from dataclasses import dataclass
from functools import wraps

import numpy as np

from rodsim.errors import FileError, UsageError
from rodsim.files import replacing

RASTER_DPI = 160
LOOK = {  # 8 to 9 points, as journals ask for; TrueType, as they do in .pdf
    "font.size": 9.0, "axes.titlesize": 9.0, "axes.labelsize": 9.0, "figure.titlesize": 10.0,
    "figure.labelsize": 9.0, "xtick.labelsize": 8.0, "ytick.labelsize": 8.0,
    "legend.fontsize": 8.0, "axes.linewidth": 0.8, "pdf.fonttype": 42,
    "axes.formatter.limits": (-3, 4), "figure.autolayout": False,
    "figure.constrained_layout.use": False,
}  # fmt: skip
SLACK = 0.015  # inches: the antialiased edge of a letter
PAD = 0.04  # inches around what is drawn
PAGE = 6.0  # inches
CHARACTERS = 14.0  # of a title in an inch
LETTER, HANDLE = 0.065, 0.45  # inches: of a legend's letter, and of what stands before its text
DECADES = 1e-6  # of the largest value: where logarithmic axes end
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


@dataclass(frozen=True)
class Sheet:
    """What a picture is drawn on: ``size`` (width, height) in inches, or None for what fits.

    dpi : points of a .png or a movie to the inch, None for the usual. title : in place of the
    case's own, "" for none, or None.
    """

    size: tuple[float, float] | None = None
    dpi: int | None = None
    title: str | None = None

    def figure(self, width: float, height: float, title: str = ""):
        """Return an empty figure of the sheet's size, or else of this one, with its title."""
        figure = new_figure(*(self.size or (width, height)))
        if text := self.titled(title, figure.get_size_inches()[0]):
            figure.suptitle(text)
        return figure

    def titled(self, title: str, width: float) -> str:
        """Return the title in lines that fit a width in inches."""
        text = title if self.title is None else self.title
        return textwrap.fill(text, max(8, int(CHARACTERS * width)))

    def save(self, figure, path) -> None:
        """Write a figure as .png, .pdf or .svg, whole or not at all; see :func:`save`."""
        if self.size:
            refuse_cut(figure)
        save(figure, path, self.dpi or RASTER_DPI)


PLAIN = Sheet()


def pretty_unit(unit: str) -> str:
    """Return a unit as people write it: ``g um^2 s^-2`` -> ``g µm² s⁻²``.

    >>> pretty_unit("um s^-1")
    'µm s⁻¹'
    """
    words = []
    for word in unit.split():
        name, _, power = word.partition("^")
        name = "µ" + name[1:] if name in ("um", "us", "ug") else name
        words.append(name + power.translate(_SUPERSCRIPTS))
    return " ".join(words)


def power_of_ten(power: int) -> str:
    """Return a power of ten as people write it; letters, for a formula is slow to draw.

    >>> power_of_ten(-6)
    '10⁻⁶'
    """
    return f"10{str(power).translate(_SUPERSCRIPTS)}"


def label(quantity: str, unit: str) -> str:
    """Return the text of an axis: the quantity and, where it has one, its unit."""
    return quantity if unit in ("", "1") else f"{quantity} ({pretty_unit(unit)})"


def new_figure(width: float, height: float):
    """Return an empty figure of a size in inches, laid out so that nothing is cut."""
    with matplotlib_needed():
        from matplotlib.figure import Figure
        from matplotlib.layout_engine import ConstrainedLayoutEngine
    pads = {"w_pad": PAD, "h_pad": PAD, "wspace": 0.01, "hspace": 0.01}
    return Figure(figsize=(width, height), layout=ConstrainedLayoutEngine(**pads))


def styled(draw):
    """Make a function draw in the look of all pictures here, whatever a user's settings are."""

    @wraps(draw)
    def drawn(*arguments, **options):
        with matplotlib_needed():
            from matplotlib import rc_context
        with rc_context(LOOK):
            return draw(*arguments, **options)

    return drawn


def save(figure, path, dpi=RASTER_DPI) -> None:
    """Write a figure as .png, .pdf or .svg, whole or not at all; raises FileError."""
    figure.set_dpi(dpi)  # letters are as wide as they will be
    settle(figure)
    figure.set_layout_engine(None)  # with one, even "none", savefig draws all twice
    with replacing(path) as temporary, drawing(path):
        figure.savefig(temporary, dpi=dpi)


def settle(figure) -> None:
    """Lay a figure out, twice where axes have equal scales: they are moved after the first time."""
    if layout := figure.get_layout_engine():
        for _ in range(1 if all(map(_stretches, figure.axes)) else 2):
            layout.execute(figure)


def _stretches(axis) -> bool:
    """Tell whether an axis fills the room that it is given, whatever its scales."""
    return axis.name == "rectilinear" and axis.get_aspect() == "auto" and not axis.get_box_aspect()


def refuse_cut(figure) -> None:
    """Raise UsageError where a figure has no room for what is on it, or cuts it."""
    size = figure.get_size_inches()
    with warnings.catch_warnings():
        warnings.filterwarnings("error", "constrained_layout not applied")
        try:
            settle(figure)
        except UserWarning:
            raise UsageError(too_small(size)) from None
    low, high = figure.get_tightbbox().get_points()
    names = [axis.yaxis.label.get_window_extent() for axis in figure.axes]
    names = [name for name in names if name.width > 1]
    meet = any(name.overlaps(other) for k, name in enumerate(names) for other in names[:k])
    if meet or (low < -SLACK).any() or (high > size + SLACK).any():
        raise UsageError(too_small(size))


def too_small(size) -> str:
    """Return what is said of a sheet of a size in inches that has no room."""
    width, height = (f"{25.4 * side:.0f}" for side in size)
    return f"--size {width}x{height}: too small for what is on it: fewer --frames, or a larger one"


@contextmanager
def drawing(path):
    """Turn what goes wrong while a picture is written into a FileError."""
    try:
        yield
    except (OSError, ValueError) as error:
        raise FileError(f"{path}: cannot be drawn: {error}") from error


@contextmanager
def matplotlib_needed():
    """Say how to get what pictures are made with, if it is not there."""
    try:
        yield
    except ImportError as error:
        raise UsageError(f"pictures need {error.name}: pip install 'rodsim[plot]'") from error


def colour_map(name: str):
    """Return one of matplotlib's colour maps, as a function of numbers from 0 to 1."""
    with matplotlib_needed():
        from matplotlib import colormaps
    return colormaps[name]


def name_values(axis, quantity: str, unit: str) -> None:
    """Write quantity and unit beside an axis of its final range, powers of ten with the unit.

    So "energy (10⁻³ g µm² s⁻²)" and not a "1e-3" in a corner, where a legend may be.
    """
    top = np.abs(axis.get_ylim()).max()
    power = int(np.floor(np.log10(top))) if top > 0.0 else 0
    if axis.get_yscale() == "log" or -3 < power < 4:
        axis.set_ylabel(label(quantity, unit))
        return
    with matplotlib_needed():
        from matplotlib.ticker import ScalarFormatter
    formatter = ScalarFormatter()
    formatter.set_powerlimits((power, power))
    axis.yaxis.set_major_formatter(formatter)
    axis.yaxis.offsetText.set_visible(False)
    plain = "" if unit in ("", "1") else f" {pretty_unit(unit)}"
    axis.set_ylabel(f"{quantity} ({power_of_ten(power)}{plain})")


def share_of_page(figure) -> float:
    """Return by how much lines are thinner and sparser in a figure that is not a page wide."""
    return float(np.clip(figure.get_size_inches()[0] / PAGE, 0.5, 1.0))


def legend_above(axis, handles=None, labels=None):
    """Put the legend of an axis above it, where no curve is, in as many columns as fit."""
    if handles is None:
        handles, labels = axis.get_legend_handles_labels()
    if not labels:
        return None
    room = axis.figure.get_size_inches()[0] - 1.0
    widest = HANDLE + LETTER * max(map(len, labels))
    return axis.legend(
        handles, labels, frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0),
        borderaxespad=0.2, ncols=max(1, min(len(labels), int(room / widest))), columnspacing=1.2,
        handlelength=2.2,
    )  # fmt: skip


def scale(axis, largest) -> None:
    """Let the values of an axis begin at 0, or be logarithmic where a short peak hides the rest.

    ``largest``: the largest curve on the axis; what is below 1e-4 of its median is cut off then.
    """
    middle = np.median(largest)
    if middle > 0.0 and np.max(largest) > 10.0 * middle:
        axis.set_yscale("log")
        axis.set_ylim(bottom=1e-4 * middle)
    else:
        axis.set_ylim(bottom=0.0)


def log_scale(axis, curves) -> None:
    """Make the values of an axis logarithmic, over at most six decades of what is drawn."""
    values = np.concatenate([np.ravel(curve) for curve in curves])
    if not (values > 0.0).any():
        raise UsageError("a logarithmic scale needs values above zero: leave out --log")
    axis.set_yscale("log")
    top = np.nanmax(values)
    axis.set_ylim(0.7 * max(np.nanmin(values[values > 0.0]), DECADES * top), 1.4 * top)


def nice_length(largest: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above ``largest``."""
    power = 10.0 ** np.floor(np.log10(largest))
    return float(max(step * power for step in (1, 2, 5) if step * power <= largest))
