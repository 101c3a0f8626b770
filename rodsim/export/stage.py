"""Rods, bodies, tracers and a wall over time as objects of K3D, for a page in the browser."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rodsim.analysis.wall import piece_of_wall
from rodsim.errors import UsageError
from rodsim.plotting.bodies import COLOUR as BODY
from rodsim.plotting.camera import make_camera

AROUND = 16  # faces around a tube
STRIPE = 0.25  # width of the line along D^1, of the tube's radius
DARK, GREY, SPECK = 0x202024, 0xB8BCC4, 0x8A4F9E  # stripe, wall, tracers
MOTE = 0.012  # size of a tracer, of the extent of the scene
VIEW_ANGLE = 40.0  # of the camera, degrees


@dataclass(frozen=True)
class Stage:
    """A plot of K3D whose time is the number of the frame, and the tubes that are its rods.

    tubes : for each rod the number of its object, and how many points are drawn of it (one more of
    a closed rod). stripes : numbers of the objects along D^1.
    """

    plot: object
    tubes: list[tuple[int, int]]
    stripes: list[int]


def build_stage(run, chosen, radius: float, hues) -> Stage:
    """Return what is seen of some frames of an open run: tubes of a radius, each of its hue."""
    k3d = _library()
    plot = k3d.plot(
        camera_auto_fit=False, camera_fov=VIEW_ANGLE, menu_visibility=False, grid_auto_fit=False,
        colorbar_object_id=0,
    )  # fmt: skip
    position = _frames(run.read, "position", chosen)
    seen = [position, *_add_surroundings(k3d, plot, run, chosen)]
    seen = np.concatenate([points.reshape(-1, 3) for points in seen])
    wall = _add_wall(k3d, plot, seen, run.wall)
    tubes, stripes = [], []
    for rod, hue in zip(run.rods, hues, strict=True):
        line = _closed(position[:, rod.nodes], rod.closed)
        tube = k3d.line(_series(line), color=hue, **_round(radius))
        plot += tube
        tubes.append((tube.id, line.shape[1]))
        if "director" in run.fields:
            first = _closed(_frames(run.read, "director", chosen)[:, rod.nodes, 0], rod.closed)
            stripe = k3d.line(_series(line + radius * first), color=DARK, **_round(STRIPE * radius))
            plot += stripe
            stripes.append(stripe.id)
    shown = np.concatenate([seen, wall, seen + radius, seen - radius])
    plot.grid = [*shown.min(axis=0), *shown.max(axis=0)]
    plot.camera = _camera(shown, run.wall is not None)
    return Stage(plot, tubes, stripes)


def _library():
    try:
        import k3d
    except ImportError as error:
        raise UsageError(f"this page needs {error.name}: pip install 'rodsim[view]'") from error
    return k3d


def _frames(read, name, chosen):
    return np.array([read(name, frame) for frame in chosen])


def _series(values):
    """Return arrays by the number of their frame, as K3D takes what changes in time."""
    return {str(number): np.float32(value) for number, value in enumerate(values)}


def _closed(values, closed):
    """Return values (T, M, 3) with the first point again at the end of a closed rod."""
    return np.concatenate([values, values[:, :1]], axis=1) if closed else values


def _round(radius):
    return {"shader": "mesh", "width": radius, "radial_segments": AROUND}


def _add_surroundings(k3d, plot, run, chosen):
    """Add bodies and tracers; yield their points."""
    if run.bodies:
        surfaces = np.array([run.surfaces(frame) for frame in chosen])
        colour = packed(BODY)
        plot += k3d.mesh(_series(surfaces), run.triangles.astype(np.uint32), color=colour)
        yield surfaces
    if "tracers" in run.fields:
        tracers = _frames(run.read, "tracers", chosen)
        size = MOTE * np.ptp(tracers, axis=(0, 1)).max()
        plot += k3d.points(_series(tracers), point_size=size, color=SPECK, shader="3d")
        yield tracers


def _add_wall(k3d, plot, seen, height):
    """Add a piece of the wall under what is seen; return its corners, (0, 3) without one."""
    corners = piece_of_wall(seen, height)
    if corners is None:
        return np.zeros((0, 3))
    faces = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32)
    plot += k3d.mesh(np.float32(corners), faces, color=GREY, opacity=0.6, side="double")
    return corners


def grid_spacing(grid) -> float:
    """Return how far K3D's heavier lines are apart, in a grid of low and high corner (6,)."""
    return 10.0 ** np.ceil(np.log10(np.max(np.subtract(grid[3:], grid[:3])))) / 10.0


def packed(colour) -> int:
    """Return red, green and blue from 0 to 1 as one number, 0xRRGGBB."""
    return int.from_bytes(bytes(round(255 * part) for part in colour[:3]))


def _camera(points, upright):
    """Return place, target and upward direction of a camera that has all points in view."""
    _, up, towards = make_camera("3d", points, upright).matrix
    low, high = points.min(axis=0), points.max(axis=0)
    middle, size = 0.5 * (low + high), np.linalg.norm(high - low)
    away = 0.5 * size / np.tan(np.radians(0.5 * VIEW_ANGLE))
    return [*(middle + away * towards), *middle, *up]
