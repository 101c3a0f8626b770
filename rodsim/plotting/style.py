"""What all pictures share: units as people write them, colours that survive grey, saving."""

from __future__ import annotations

from contextlib import contextmanager

import numpy as np

from rodsim.errors import FileError, UsageError
from rodsim.files import replacing

COLOURS = "viridis"  # its lightness rises steadily, so it reads in grey as well
RASTER_DPI = 160
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


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


def label(quantity: str, unit: str) -> str:
    """Return the text of an axis: the quantity and, where it has one, its unit."""
    return quantity if unit in ("", "1") else f"{quantity} ({pretty_unit(unit)})"


def new_figure(width: float, height: float):
    """Return an empty figure of a size in inches, laid out so that nothing is cut."""
    with matplotlib_needed():
        from matplotlib.figure import Figure
    return Figure(figsize=(width, height), layout="constrained")


def save(figure, path) -> None:
    """Write a figure as .png, .pdf or .svg, whole or not at all; raises FileError."""
    with replacing(path) as temporary, drawing(path):
        figure.savefig(temporary, dpi=RASTER_DPI)


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


def nice_length(largest: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above ``largest``."""
    power = 10.0 ** np.floor(np.log10(largest))
    return float(max(step * power for step in (1, 2, 5) if step * power <= largest))
