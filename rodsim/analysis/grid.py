"""The points at which a flow is wanted: a line, a plane or a box with equal steps along each axis.

In words, as the command takes them (sizes follow the rods, with a margin):

    plane            the plane of the rods' two largest extents, through their middle
    plane:yz         that plane; plane:yz@0.5 at x = 0.5
    line:z           a line along z through the middle; line:z@0.5,2 at x = 0.5, y = 2
    box              all around the rods
    0,-2:2:41,-3:3:61    x = 0, 41 values of y from -2 to 2, 61 values of z from -3 to 3
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rodsim.errors import UsageError

AXES = "xyz"
MARGIN = 0.35  # of the largest extent, on each side
RESOLUTION = {1: 400, 2: 80, 3: 32}  # points along the longest side of a line, a plane, a box
MOST_POINTS = 50_000_000


@dataclass(frozen=True)
class Grid:
    """Coordinates along x, y and z: arrays of equal steps; one value fixes that coordinate."""

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of points along each axis."""
        return len(self.x), len(self.y), len(self.z)

    @property
    def varying(self) -> list[int]:
        """Numbers of the axes along which there is more than one point."""
        return [axis for axis, count in enumerate(self.shape) if count > 1]

    @property
    def origin(self) -> tuple[float, float, float]:
        """The first point."""
        return float(self.x[0]), float(self.y[0]), float(self.z[0])

    @property
    def step(self) -> tuple[float, float, float]:
        """Distance of neighbouring points along each axis; 1 where there is only one."""
        return tuple(float(a[1] - a[0]) if len(a) > 1 else 1.0 for a in (self.x, self.y, self.z))

    @property
    def points(self) -> np.ndarray:
        """All points (n, 3); x changes slowest, z fastest."""
        mesh = np.meshgrid(self.x, self.y, self.z, indexing="ij")
        return np.stack(mesh, axis=-1).reshape(-1, 3)


def make_grid(
    text: str, position: np.ndarray, resolution=None, default=RESOLUTION, floor=None
) -> Grid:
    """Return the grid that a text describes, around rods with ``position`` (N, 3).

    ``resolution``: points along the longest side, where the text does not say; if None, ``default``
    of the number of axes. ``floor``: height of a wall; a grid that follows the rods begins on it
    where its margin would reach below. Raises UsageError, also where all of a grid is below.
    """
    kind, _, rest = text.strip().partition(":")
    if kind not in ("line", "plane", "box"):
        return _checked(text, _explicit(text), floor)
    letters, _, fixed = rest.partition("@")
    middle, extent = _middle_and_extent(position)
    axes = _axes(text, kind, letters, extent)
    at = _fixed(text, fixed, axes, middle)
    grid = _around(axes, at, middle, extent, resolution or default[len(axes)])
    if floor is not None and grid.shape[2] > 1 and grid.z[0] < floor:
        count = int(np.ceil((grid.z[-1] - floor) / grid.step[2])) + 1
        grid = Grid(grid.x, grid.y, floor + grid.step[2] * np.arange(count))
    return _checked(text, grid, floor)


def _checked(text, grid, floor):
    if floor is not None and grid.z[-1] < floor:
        raise UsageError(f"grid {text!r}: all of it lies below the wall, z = {floor:g}")
    if np.prod(grid.shape, dtype=float) > MOST_POINTS:
        raise UsageError(f"grid {text!r}: more than {MOST_POINTS} points")
    return grid


def _middle_and_extent(position):
    low, high = position.min(axis=0), position.max(axis=0)
    middle, extent = 0.5 * (low + high), high - low
    middle[np.abs(middle) < 1e-9 * extent.max()] = 0.0  # what is left of a symmetric sum
    return middle, extent


def _axes(text, kind, letters, extent):
    """Return the numbers of the axes along which a grid of some kind extends."""
    wanted = {"line": 1, "plane": 2, "box": 3}[kind]
    if not letters:
        return sorted(np.argsort(-extent, kind="stable")[:wanted].tolist())
    axes = sorted({AXES.find(letter) for letter in letters})
    if -1 in axes or len(axes) != len(letters) or len(axes) != wanted:
        example = {"line": "line:z", "plane": "plane:yz", "box": "box"}[kind]
        raise UsageError(f"grid {text!r}: name {wanted} different axes, as in {example}")
    return axes


def _fixed(text, values, axes, middle):
    """Return x, y, z of the grid's middle: as given after @, else that of the rods."""
    at, others = middle.copy(), [axis for axis in range(3) if axis not in axes]
    if not values:
        return at
    numbers = [_number(text, word) for word in values.split(",")]
    if len(numbers) != len(others):
        names = ", ".join(AXES[axis] for axis in others)
        raise UsageError(f"grid {text!r}: after @ give {names or 'nothing'}")
    at[others] = numbers
    return at


def _around(axes, at, middle, extent, resolution):
    """Return a grid with equal steps along all of its axes, the rods and a margin inside."""
    sides = extent + 2.0 * MARGIN * extent.max()
    step = sides[axes].max() / max(resolution - 1, 1)
    values = [np.array([coordinate]) for coordinate in at]
    for axis in axes:
        count = max(2, round(sides[axis] / step) + 1)
        values[axis] = middle[axis] + step * (np.arange(count) - 0.5 * (count - 1))
    return Grid(*values)


def _explicit(text):
    parts = text.split(",")
    if len(parts) != 3:
        raise UsageError(
            f"grid {text!r}: write plane, plane:yz, line:z, box, or three of FIRST:LAST:COUNT or "
            "a number, for x, y, z: 0,-2:2:41,-3:3:61"
        )
    return Grid(*(_range(text, part) for part in parts))


def _range(text, part):
    words = part.split(":")
    if len(words) == 1:
        return np.array([_number(text, part)])
    if len(words) != 3 or not words[2].strip().isdecimal() or int(words[2]) < 2:
        raise UsageError(f"grid {text!r}: {part!r} must be a number or FIRST:LAST:COUNT, COUNT > 1")
    first, last = _number(text, words[0]), _number(text, words[1])
    if not first < last:
        raise UsageError(f"grid {text!r}: in {part!r} the last value must be above the first")
    return np.linspace(first, last, min(int(words[2]), MOST_POINTS + 1))


def _number(text, word):
    try:
        value = float(word)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise UsageError(f"grid {text!r}: {word!r} is not a number")
    return value
