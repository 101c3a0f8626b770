"""What colours mean in pictures: a scale of numbers, or names. All can be seen on white paper.

Every colour of a rod has a contrast of at least 1.9 with white (WCAG's ratio), so that it stands
out from the page, and a white stripe from it. The maps of numbers without a sign grow lighter
steadily, so they read in grey; those of signed numbers grow darker to both sides.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rodsim.plotting import style

SEQUENTIAL = ("viridis", 0.0, 0.75)  # without its yellow end
SIGNED = ("#053061", "#3a7fbd", "#b9b9b9", "#d1573b", "#67001f")
RODS = ("#0072b2", "#e69f00", "#009e73", "#d55e00", "#56b4e9", "#cc79a7", "#000000")  # Okabe, Ito
SMALL = 0.02  # of the largest value: signs that differ by less do not count
FAR = 1.5  # times the range of the other frames: where the first frame sets no range


@dataclass(frozen=True)
class Scale:
    """Numbers of a quantity as colours, between ``low`` and ``high``.

    extend : which ends of the bar are pointed, for values beyond: neither, min, max or both.
    log : colours change with the logarithm; low is above 0.
    """

    colours: Any
    low: float
    high: float
    quantity: str
    unit: str = ""
    extend: str = "neither"
    log: bool = False

    def __call__(self, values) -> np.ndarray:
        """Return rgba (..., 4) of values (...)."""
        return self.colours(np.ma.filled(self.norm()(np.asarray(values)), 0.0))

    def norm(self):
        """Return matplotlib's way from numbers to the interval from 0 to 1."""
        with style.matplotlib_needed():
            from matplotlib.colors import LogNorm, Normalize
        return (LogNorm if self.log else Normalize)(self.low, self.high)

    def draw(self, figure, axes):
        """Draw the bar beside axes; return it."""
        with style.matplotlib_needed():
            from matplotlib.cm import ScalarMappable
        mapped = ScalarMappable(self.norm(), self.colours)
        bar = figure.colorbar(mapped, ax=axes, extend=self.extend, shrink=0.8, aspect=25, pad=0.02)
        style.name_values(bar.ax, self.quantity, self.unit)
        return bar


def sequential(paper=True):
    """Return the map of numbers without a sign; all of it where nothing is on white ``paper``."""
    return part_of(*SEQUENTIAL) if paper else style.colour_map(SEQUENTIAL[0])


def signed(paper=True):
    """Return the map of numbers of both signs: blue below, red above, grey or white between."""
    if not paper:
        return style.colour_map("RdBu_r")
    with style.matplotlib_needed():
        from matplotlib.colors import LinearSegmentedColormap
    return LinearSegmentedColormap.from_list("signed", SIGNED)


def part_of(name: str, low: float, high: float):
    """Return part of one of matplotlib's colour maps as a colour map."""
    with style.matplotlib_needed():
        from matplotlib.colors import ListedColormap
    return ListedColormap(style.colour_map(name)(np.linspace(low, high, 256)))


def scale_of(values, quantity: str, unit: str, asked=None, paper=True) -> Scale:
    """Return the colours of values: a list of arrays (F, ...) of F frames.

    From 0, or the same to both sides of it where signs differ. The first frame does not count where
    it alone is far off the others: a rod seldom starts at rest. asked : lowest and highest instead.
    paper : what has the colours lies on white; otherwise they fill all of a map.
    """
    every = np.concatenate([np.reshape(v, (len(v), -1)) for v in values], axis=1)
    later = every[1:]
    low, high = _range(later) if len(later) and _far(every[0], later) else _range(every)
    both = min(-low, high) > SMALL * max(-low, high)
    if asked:
        low, high = asked
        both = low < 0.0 < high
    elif both:
        low, high = -max(-low, high), max(-low, high)
    elif high > -low:
        low, high = 0.0, high
    else:
        low, high = low, 0.0 if low < 0.0 else 1.0
    colours = signed(paper) if both else sequential(paper)
    colours = colours if both or high > 0.0 else colours.reversed()
    return Scale(colours, low, high, quantity, unit, pointed(every, low, high))


def pointed(values, low, high) -> str:
    """Return which ends of a bar are pointed: those that values lie beyond."""
    slack = 1e-9 * (high - low)
    beyond = bool(np.min(values) < low - slack), bool(np.max(values) > high + slack)
    return {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[beyond]


def _range(values):
    return float(np.min(values)), float(np.max(values))


def _far(first, later):
    low, high = _range(later)
    span = max(abs(low), abs(high), high - low)
    return np.abs(first).max() > FAR * span


def of_rods(names) -> dict[str, tuple]:
    """Return rgba of each rod: colours told apart by all eyes, or of many a sequence."""
    with style.matplotlib_needed():
        from matplotlib.colors import to_rgba
    if len(names) <= len(RODS):
        return {name: to_rgba(colour) for name, colour in zip(names, RODS, strict=False)}
    shades = sequential()(np.linspace(0.0, 1.0, len(names)))
    return {name: tuple(shade) for name, shade in zip(names, shades, strict=True)}


def contrast_with_white(colour) -> float:
    """Return the ratio of the luminance of white to that of a colour, (1.05)/(Y + 0.05), WCAG 2."""
    rgb = np.asarray(colour, float)[:3]
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    return float(1.05 / (linear @ (0.2126, 0.7152, 0.0722) + 0.05))
