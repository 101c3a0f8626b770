"""Shapes over time: one panel for each time, or all times over each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rodsim.analysis.wall import piece_of_wall
from rodsim.plotting import style
from rodsim.plotting.camera import AXES, Camera
from rodsim.plotting.directors import LAYERS, draw_directors, draw_key
from rodsim.plotting.rod import draw_rods, draw_tracers
from rodsim.plotting.wall import draw_wall, with_wall

WIDTH, HEIGHT = 8.0, 5.4  # inches that the panels of a figure may take
TITLE, FRAME, BAR = 0.3, 0.55, 0.9  # inches for a panel's title, for what is below, a colour bar
MARGIN = 0.04  # of the longest side, around what is drawn


@dataclass(frozen=True)
class Shapes:
    """Frames to draw: time (T,), position (T, N, 3), director (T, N, 3, 3) or None, their rods.

    colours : rgba for each frame and rod, (4,) or (S, 4). tracers : (T, P, 3), P may be 0.
    units : names of the units of ``length`` and ``time``. size : diameter or width of the rods.
    wall : height of a wall, or None. arrows : length of D^1 and D^2 drawn as arrows, 0 for none.
    surfaces : of bodies, (T, S, 3), and triangles (F, 3) between their points; or None.
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

    def bounds(self, camera: Camera) -> np.ndarray:
        """Return [[left, bottom], [right, top]] of all frames, with a margin."""
        points = self._points()
        shown = with_wall(points, camera, piece_of_wall(points, self.wall))
        seen = camera.project(shown)[:, :2]
        low, high = seen.min(axis=0), seen.max(axis=0)
        extent = (high - low).max() or np.ptp(points, axis=0).max() or 1.0  # seen end on
        space = MARGIN * extent + max(self.size if self.kind != "line" else 0.0, self.arrows)
        return np.array([low - space, high + space])

    def _points(self):
        shown = [self.position, self.tracers]
        if self.surfaces is not None:
            shown.append(self.surfaces)
        return np.concatenate(shown, axis=1).reshape(-1, 3)

    def stamp(self, frame: int) -> str:
        """Return the time of a frame with its unit."""
        return f"t = {self.time[frame]:.4g} {style.pretty_unit(self.units['time'])}"


def draw_panels(shapes: Shapes, camera: Camera, title: str = "", key=None):
    """Return a figure with a panel for each frame, all at the same scale.

    ``key``: (colour map, lowest, highest, text) of the colour bar, or None for none.
    """
    bounds = shapes.bounds(camera)
    count = len(shapes.time)
    columns, width, height = _grid(count, bounds[1] - bounds[0])
    rows = -(-count // columns)
    figure = style.new_figure(
        columns * width + (0.7 if camera.flat else 0.1) + (BAR if key else 0.0),
        rows * (height + TITLE) + FRAME + (0.35 if title else 0.0),
    )
    axes = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).ravel()
    for frame, axis in enumerate(axes[:count]):
        set_stage(axis, camera, bounds)
        shapes.draw(axis, camera, frame)
        axis.set_title(shapes.stamp(frame), fontsize=10, loc="left", pad=3)
    for axis in axes[count:]:
        axis.set_visible(False)
    annotate(figure, axes[0], camera, bounds, shapes.units["length"])
    _finish(figure, list(axes[:count]), title, key, shapes.arrows)
    return figure


def draw_overlay(shapes: Shapes, camera: Camera, title: str = "", key=None):
    """Return a figure with all frames over each other, later ones on top."""
    bounds = shapes.bounds(camera)
    _, width, height = _grid(1, bounds[1] - bounds[0])
    figure = style.new_figure(width + 0.8 + (BAR if key else 0.0), height + 1.2)
    axis = figure.add_subplot()
    set_stage(axis, camera, bounds)
    for frame in range(len(shapes.time)):
        shapes.draw(axis, camera, frame)
        for drawn in axis.collections[-1 - (LAYERS if shapes.arrows else 0) :]:
            drawn.set_zorder(2.0 + frame)
    annotate(figure, axis, camera, bounds, shapes.units["length"])
    _finish(figure, [axis], title, key, shapes.arrows)
    return figure


def set_stage(axis, camera: Camera, bounds) -> None:
    """Give an axis equal scales and its limits; a tilted view has no ticks."""
    axis.set_aspect("equal")
    axis.set_xlim(*bounds[:, 0])
    axis.set_ylim(*bounds[:, 1])
    if not camera.flat:
        axis.set_axis_off()


def draw_scale(axis, bounds, unit: str):
    """Draw a bar of a round length at the bottom left of an axis; return the axis."""
    width = bounds[1, 0] - bounds[0, 0]
    length = style.nice_length(0.25 * width)
    left, bottom = bounds[0] + 0.02 * width
    axis.plot([left, left + length], [bottom, bottom], color="0.2", lw=2.0, solid_capstyle="butt")
    axis.annotate(
        f"{length:g} {style.pretty_unit(unit)}", (left + length, bottom), xytext=(4, 0),
        textcoords="offset points", va="center", fontsize=9, color="0.2",
    )  # fmt: skip
    return axis


def draw_compass(figure, camera: Camera):
    """Draw the directions of x, y and z as arrows at the bottom left of a figure, below the rest.

    Returns the axis they are on.
    """
    width, height = figure.get_size_inches()
    figure.get_layout_engine().set(rect=(0.0, FRAME / height, 1.0, 1.0 - FRAME / height))
    axis = figure.add_axes((0.08 / width, 0.04 / height, FRAME / width, FRAME / height))
    axis.set_in_layout(False)
    axis.set_axis_off()
    axis.set_xlim(-1.5, 1.5)
    axis.set_ylim(-1.5, 1.5)
    for name, (right, up, _) in zip(AXES, camera.matrix.T, strict=True):
        arrow = {"arrowstyle": "->", "color": "0.2", "lw": 1.0, "shrinkA": 0, "shrinkB": 0}
        axis.annotate("", (right, up), xytext=(0, 0), arrowprops=arrow)
        axis.text(1.4 * right, 1.4 * up, name, ha="center", va="center", fontsize=8, color="0.2")
    return axis


def _grid(count, extent):
    """Return columns and the size of a panel, in inches: as large as can be, few gaps."""
    aspect = max(extent[1] / extent[0], 0.02)
    choices = []
    for columns in range(1, min(count, 4) + 1):
        rows = -(-count // columns)
        width = min(WIDTH / columns, (HEIGHT / rows - TITLE) / aspect, 5.5)
        gaps = rows * columns - count
        choices.append((width * (0.85 if gaps else 1.0), columns, width))
    _, columns, width = max(choices)
    return columns, width, width * aspect


def annotate(figure, axis, camera: Camera, bounds, unit: str) -> None:
    """Say how large things are and where the axes point."""
    if camera.flat:
        figure.supxlabel(style.label(camera.flat[0], unit), fontsize=10)
        figure.supylabel(style.label(camera.flat[1], unit), fontsize=10)
        return
    draw_scale(axis, bounds, unit)
    draw_compass(figure, camera)


def _finish(figure, axes, title, key, arrows):
    if arrows:
        draw_key(figure)
    if title:
        figure.suptitle(title, fontsize=11)
    if key:
        with style.matplotlib_needed():
            from matplotlib.cm import ScalarMappable
            from matplotlib.colors import Normalize
        colours, low, high, text = key
        mapped = ScalarMappable(Normalize(low, high), colours)
        figure.colorbar(mapped, ax=axes, label=text, shrink=0.7, aspect=25, pad=0.02)
