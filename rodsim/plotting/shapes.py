"""Shapes over time: one panel for each time, or all times over each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rodsim.analysis.wall import piece_of_wall
from rodsim.errors import UsageError
from rodsim.plotting import style
from rodsim.plotting.camera import Camera
from rodsim.plotting.directors import LAYERS, draw_directors
from rodsim.plotting.rod import draw_rods, draw_tracers
from rodsim.plotting.surround import annotate, around, draw_key, set_stage
from rodsim.plotting.wall import draw_wall, with_wall

WIDTH, HEIGHT = 8.0, 5.4  # inches that the panels of a figure may take
TITLE = 0.22  # inches of the heading of a panel
GAP = 0.14  # inches between panels
WIDEST, LOWEST = 5.5, 0.3  # inches of a panel
MARGIN = 0.04  # of the longest side, around what is drawn


@dataclass(frozen=True)
class Shapes:
    """Frames to draw: time (T,), position (T, N, 3), director (T, N, 3, 3) or None, their rods.

    colours : rgba for each frame and rod, (4,) or (S, 4). tracers : (T, P, 3), P may be 0.
    units : names of the units of ``length`` and ``time``. size : diameter or width of the rods.
    wall : height of a wall, or None. arrows : length of D^1 and D^2 drawn as arrows, 0 for none.
    surfaces : of bodies, (T, S, 3), and triangles (F, 3) between their points; or None.
    names : of the frames, in place of their times; or None.
    """

    time: np.ndarray
    position: np.ndarray
    director: np.ndarray | None
    rods: list
    colours: list
    tracers: np.ndarray
    units: dict
    size: float
    kind: str
    wall: float | None = None
    arrows: float = 0.0
    surfaces: np.ndarray | None = None
    triangles: np.ndarray | None = None
    names: tuple[str, ...] | None = None

    def draw(self, axis, camera: Camera, frame: int):
        """Draw one frame on an axis that has its limits; return the axis."""
        draw_wall(axis, camera, piece_of_wall(self._points(), self.wall))
        if self.tracers.shape[1]:
            draw_tracers(axis, camera, self.tracers[frame])
        director = None if self.director is None else self.director[frame]
        shape = self.position[frame], director, self.size, self.colours[frame], self.kind
        bodies = None if self.surfaces is None else (self.surfaces[frame], self.triangles)
        draw_rods(axis, camera, self.rods, *shape, bodies)
        if self.arrows:
            draw_directors(axis, camera, self.rods, *shape[:2], self.arrows)
        return axis

    def bounds(self, camera: Camera, frame=slice(None)) -> np.ndarray:
        """Return [[left, bottom], [right, top]] of all frames or one, with a margin."""
        points = self._points()
        shown = with_wall(self._points(frame), camera, piece_of_wall(points, self.wall))
        seen = camera.project(shown)[:, :2]
        low, high = seen.min(axis=0), seen.max(axis=0)
        extent = np.ptp(points, axis=0).max() or 1.0
        space = MARGIN * extent + max(self.size if self.kind != "line" else 0.0, self.arrows)
        return np.array([low - space, high + space])

    def _points(self, frame=slice(None)):
        shown = [self.position, self.tracers]
        if self.surfaces is not None:
            shown.append(self.surfaces)
        return np.concatenate([points[frame].reshape(-1, 3) for points in shown])

    def stamp(self, frame: int) -> str:
        """Return the name of a frame, or its time with its unit."""
        if self.names:
            return self.names[frame]
        return f"t = {self.time[frame]:.4g} {style.pretty_unit(self.units['time'])}"

    def narrowest(self) -> float:
        """Return how wide a panel must be for its heading, in inches."""
        return 0.1 + style.LETTER * max(len(self.stamp(k)) for k in range(len(self.time)))


def draw_panels(shapes: Shapes, camera: Camera, title: str = "", key=None, sheet=style.PLAIN):
    """Return a figure with a panel for each frame, all at the same scale.

    ``key``: what colours mean: a :class:`~rodsim.plotting.colours.Scale`, rgba by name, or None.
    """
    bounds, count = shapes.bounds(camera), len(shapes.time)
    beside, below = around(camera, key, sheet, title, WIDTH)
    columns, width, height = _grid(
        count, bounds[1] - bounds[0], sheet, (beside, below), shapes.narrowest()
    )
    bounds = _widened(bounds, width / height)
    rows = -(-count // columns)
    full = columns * (width + GAP) + beside, rows * (height + TITLE) + below
    figure = sheet.figure(*full, title)
    grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    axes = grid.ravel()
    for frame, axis in enumerate(axes[:count]):
        set_stage(axis, camera, bounds, (width, height))
        shapes.draw(axis, camera, frame)
        axis.set_title(shapes.stamp(frame), loc="left", pad=3)
    for axis in axes[count:]:
        axis.set_visible(False)
    annotate(grid, camera, bounds, shapes.units["length"], key)
    draw_key(figure, list(axes[:count]), camera, key)
    return figure


def draw_overlay(shapes: Shapes, camera: Camera, title: str = "", key=None, sheet=style.PLAIN):
    """Return a figure with all frames over each other, later ones on top."""
    bounds = shapes.bounds(camera)
    beside, below = around(camera, key, sheet, title, WIDTH)
    _, width, height = _grid(1, bounds[1] - bounds[0], sheet, (beside, below), shapes.narrowest())
    bounds = _widened(bounds, width / height)
    figure = sheet.figure(width + beside + GAP, height + below + TITLE, title)
    axis = figure.add_subplot()
    set_stage(axis, camera, bounds, (width, height))
    for frame in range(len(shapes.time)):
        shapes.draw(axis, camera, frame)
        for drawn in axis.collections[-1 - (LAYERS if shapes.arrows else 0) :]:
            drawn.set_zorder(2.0 + frame)
    annotate(np.array([[axis]]), camera, bounds, shapes.units["length"], key)
    draw_key(figure, [axis], camera, key)
    return figure


def _grid(count, extent, sheet, taken, narrowest):
    """Return columns and the size of a panel, in inches: as large as can be, few gaps.

    A panel is never narrower than its heading, however tall what it shows. Raises UsageError where
    a sheet has no room for that.
    """
    room = (WIDTH, HEIGHT) if sheet.size is None else np.subtract(sheet.size, taken)
    aspect = max(extent[1] / extent[0], 0.02)
    choices = []
    for columns in range(1, max(1, min(count, int(room[0] / (narrowest + GAP)))) + 1):
        rows = -(-count // columns)
        width = min(room[0] / columns - GAP, (room[1] / rows - TITLE) / aspect, WIDEST)
        high = max(width * aspect, LOWEST)
        if sheet.size is None or rows * (high + TITLE) < room[1] + 0.01:
            gaps = rows * columns - count
            choices.append((round(width * (0.85 if gaps else 1.0), 6), columns, width, high))
    if not choices or (sheet.size and narrowest > room[0]):
        raise UsageError(style.too_small(sheet.size))
    _, columns, width, high = max(choices)
    return columns, max(width, narrowest), high


def _widened(bounds, shape):
    """Return bounds made wider or higher, about their middle, to the shape of their panel."""
    width, height = bounds[1] - bounds[0]
    more = np.maximum([height * shape, width / shape], (width, height)) - (width, height)
    return bounds + 0.5 * more * np.array([[-1.0], [1.0]])
