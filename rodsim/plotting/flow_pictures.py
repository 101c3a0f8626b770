"""Whole pictures of a flow: chooses by the grid what to draw, and draws the rods into it."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from rodsim.analysis.grid import AXES
from rodsim.analysis.wall import piece_of_wall
from rodsim.errors import UsageError
from rodsim.plotting import style
from rodsim.plotting.bodies import draw_bodies
from rodsim.plotting.camera import make_camera
from rodsim.plotting.colours import Scale, part_of, pointed, sequential
from rodsim.plotting.flow import (
    BOX_ARROWS,
    PRESSURE,
    SPEED,
    draw_box,
    draw_line_profile,
    draw_paths,
    draw_plane,
)
from rodsim.plotting.rod import draw_rods
from rodsim.plotting.surround import BAR, FRAME, annotate, set_stage
from rodsim.plotting.wall import draw_wall, mark_wall, with_wall

WIDTH, HEIGHT = 7.0, 7.0  # inches
FADED = 1e-3  # of the largest speed: where logarithmic colours end
BAND = 0.03  # of the longest side: what is seen of a wall's far side
ROD = (0.75, 0.22, 0.1, 1.0)


@style.styled
def plot_flow(flow, scene, out, colour="speed", arrows=False, log=False, sheet=style.PLAIN) -> None:
    """Draw a flow to a file: profiles along a line, a map of a plane, or arrows in a box.

    ``flow``: :class:`~rodsim.analysis.flow.Flow`. ``scene``: position, director, rods, units,
    thickness, wall and title of what drives it. What lies below a wall is left out. ``log``:
    colours of the speed change with its logarithm.
    """
    flow = _in_fluid(flow)
    varying = flow.grid.varying
    if log and (len(varying) < 2 or (len(varying) == 2 and colour != "speed")):
        raise UsageError("--log is for colours of speed, in a plane or a box")
    if len(varying) == 3:
        figure = _box(flow, scene, log, sheet)
    elif len(varying) == 2:
        figure = _plane(flow, scene, colour, arrows, log, sheet)
    else:
        figure = _line(flow, scene, sheet)
    sheet.save(figure, out)


@style.styled
def plot_paths(time, paths, scene, out, sheet=style.PLAIN) -> None:
    """Draw the paths of tracers to a file, with the rods at the end."""
    points = np.concatenate([paths[np.isfinite(paths).all(axis=2)], scene.position])
    if scene.bodies is not None:
        points = np.concatenate([points, scene.bodies[0]])
    camera = make_camera("auto", points, upright=scene.wall is not None)
    wall = piece_of_wall(points, scene.wall)
    seen = camera.project(with_wall(points, camera, wall))[:, :2]
    low, high = seen.min(axis=0), seen.max(axis=0)
    bounds = np.array([low, high]) + 0.05 * (high - low).max() * np.array([[-1], [1]])
    figure, axis = _stage(camera, bounds, scene, None, sheet)
    draw_wall(axis, camera, wall)
    scale = Scale(sequential(), time[0], time[-1], "time", scene.units["time"])
    draw_paths(axis, camera, time, paths, scale)
    _draw_rods(axis, camera, scene)
    scale.draw(figure, axis)
    sheet.save(figure, out)


def _speeds(speed, scene, log, *part):
    """Return the colours of speeds, which begin at 0, or where they have faded."""
    top = float(speed.max()) or 1.0
    low = max(float(speed.min()), FADED * top) if log else 0.0
    ends = pointed(speed, low, top)
    return Scale(part_of(*part), low, top, "speed", _unit(scene, "speed"), ends, log)


def _in_fluid(flow):
    """Return a flow without the planes of its grid that lie below a wall."""
    grid = flow.grid
    there = np.isfinite(flow.velocity[:, 0]).reshape(grid.shape).any(axis=(0, 1))
    if there.all():
        return flow
    keep = np.tile(there, len(grid.x) * len(grid.y))
    above = replace(grid, z=grid.z[there])
    return replace(flow, grid=above, velocity=flow.velocity[keep], pressure=flow.pressure[keep])


def _title(scene, time):
    stamp = "" if time is None else f"t = {time:.4g} {style.pretty_unit(scene.units['time'])}"
    return ", ".join(part for part in (scene.title, stamp) if part)


def _unit(scene, kind):
    length, mass, time = (scene.units[key] for key in ("length", "mass", "time"))
    return f"{length} {time}^-1" if kind == "speed" else f"{mass} {length}^-1 {time}^-2"


def _stage(camera, bounds, scene, time, sheet):
    """Return a figure and an axis with room for what is inside ``bounds`` and a colour bar."""
    width, height = bounds[1] - bounds[0]
    scale = min((WIDTH - BAR) / width, HEIGHT / height)
    size = max(scale * width, 3.0), max(scale * height, 0.8)
    figure = sheet.figure(size[0] + BAR + 0.4, size[1] + FRAME + 0.5, _title(scene, time))
    axis = figure.add_subplot()
    set_stage(axis, camera, bounds, np.minimum(size, figure.get_size_inches()))
    annotate(np.array([[axis]]), camera, bounds, scene.units["length"])
    return figure, axis


def _draw_rods(axis, camera, scene):
    """Draw the rods as tubes in a tilted view; in a plane as lines with a light edge.

    Bodies in their places, in a plane behind the rods.
    """
    colours = [ROD] * len(scene.rods)
    if not camera.flat:
        draw_rods(
            axis, camera, scene.rods, scene.position, scene.director, scene.thickness, colours,
            bodies=scene.bodies,
        )  # fmt: skip
        axis.collections[-1].set_zorder(4)
        return
    if scene.bodies is not None:
        draw_bodies(axis, camera, *scene.bodies, zorder=3)
    share = style.share_of_page(axis.figure)
    for colour, width in (((1.0, 1.0, 1.0, 1.0), 4.5 * share), (ROD, 2.6 * share)):
        draw_rods(axis, camera, scene.rods, scene.position, None, 0.0, [colour] * len(colours),
                  "line")  # fmt: skip
        axis.collections[-1].set(linewidths=width, zorder=4)


def _plane(flow, scene, colour, arrows, log, sheet):
    grid = flow.grid
    upright = scene.wall is not None  # z up
    a, b = sorted(grid.varying, key=lambda k: (upright and k == 2, -grid.shape[k] * grid.step[k]))
    fixed = ({0, 1, 2} - {a, b}).pop()
    coordinates = grid.x, grid.y, grid.z

    def seen(values):
        cube = np.squeeze(values.reshape(*grid.shape, *values.shape[1:]), axis=fixed)
        return cube if a < b else cube.swapaxes(0, 1)

    velocity, speed = seen(flow.velocity), seen(np.linalg.norm(flow.velocity, axis=1))
    camera = make_camera(AXES[a] + AXES[b], scene.position)
    right, up = coordinates[a], coordinates[b]
    bounds = np.array([[right[0], up[0]], [right[-1], up[-1]]])
    wall = _wall_below(flow, scene)
    if wall is not None and fixed != 2:  # room for a line with its far side
        bounds[0, 1] = wall - BAND * np.ptp(bounds, axis=0).max()
    figure, axis = _stage(camera, bounds, scene, flow.time, sheet)
    if colour == "speed":
        shown, scale = speed, _speeds(speed, scene, log, *SPEED)
    else:
        shown = seen(flow.pressure)
        most = float(np.percentile(np.abs(shown), 99.0)) or 1.0
        unit, ends = _unit(scene, colour), pointed(shown, -most, most)
        scale = Scale(part_of(*PRESSURE), -most, most, colour, unit, ends)
    draw_plane(axis, right, up, velocity[..., [a, b]], shown, scale, arrows)
    axis.set_xlim(*bounds[:, 0])
    axis.set_ylim(*bounds[:, 1])
    if wall is not None:
        draw_wall(axis, camera, piece_of_wall(grid.points, wall))
    _draw_rods(axis, camera, scene)
    where = style.label(f"{AXES[fixed]} = {coordinates[fixed][0]:.4g}", "")
    unit = style.pretty_unit(scene.units["length"])
    said = "; arrows: direction only" if arrows else ""
    axis.set_title(f"plane {where} {unit}{said}", loc="left", pad=3)
    return figure


def _wall_below(flow, scene):
    """Return the height of a wall that a grid comes as close to as its step, or None."""
    grid = flow.grid
    near = scene.wall is not None and grid.z[0] - scene.wall <= grid.step[2] * (1.0 + 1e-9)
    return scene.wall if near and grid.shape[2] > 1 else None


def _line(flow, scene, sheet):
    grid = flow.grid
    along = grid.varying[0] if grid.varying else 2
    coordinates = grid.x, grid.y, grid.z
    figure = sheet.figure(6.4, 5.4, _title(scene, flow.time))
    top, bottom = figure.subplots(2, 1, sharex=True)
    curves = {f"u_{name}": flow.velocity[:, i] for i, name in enumerate(AXES)}
    draw_line_profile(top, coordinates[along], curves, "velocity", _unit(scene, "speed"))
    pressure = {"pressure": flow.pressure}
    draw_line_profile(bottom, coordinates[along], pressure, "pressure", _unit(scene, "pressure"))
    if (wall := _wall_below(flow, scene)) is not None:
        for axis in (top, bottom):
            axis.set_xlim(left=wall - BAND * np.ptp(grid.z))
            mark_wall(axis, wall, upright=True)
    unit = scene.units["length"]
    bottom.set_xlabel(style.label(AXES[along], unit))
    others = [f"{AXES[i]} = {coordinates[i][0]:.4g}" for i in range(3) if i != along]
    where = f"line {', '.join(others)} {style.pretty_unit(unit)}"
    bottom.set_title(where, loc="left", pad=3)
    return figure


def _box(flow, scene, log, sheet):
    grid = flow.grid
    thin = [max(1, round(max(grid.shape) / BOX_ARROWS))] * 3
    pick = tuple(slice(t // 2, None, t) for t in thin)
    points, velocity = (
        values.reshape(*grid.shape, 3)[pick].reshape(-1, 3)
        for values in (grid.points, flow.velocity)
    )
    camera = make_camera("3d", grid.points, upright=scene.wall is not None)
    wall = piece_of_wall(grid.points, scene.wall)
    seen = camera.project(with_wall(grid.points, camera, wall))[:, :2]
    bounds = np.array([seen.min(axis=0), seen.max(axis=0)])
    figure, axis = _stage(camera, bounds, scene, flow.time, sheet)
    draw_wall(axis, camera, wall)
    scale = _speeds(np.linalg.norm(velocity, axis=1), scene, log, "YlGnBu", 0.3, 1.0)
    draw_box(axis, camera, points, velocity, scale)
    scale.draw(figure, axis)
    unit = style.pretty_unit(_unit(scene, "speed"))
    axis.set_title(f"longest arrow {scale.high:.3g} {unit}", loc="left", pad=3)
    _draw_rods(axis, camera, scene)
    return figure


def scene_to_draw(run, frame, title, thickness):
    """Return what the pictures here need to know of a run's rods and bodies in one frame."""
    return SimpleNamespace(
        bodies=(run.surfaces(frame), run.triangles) if run.bodies else None,
        position=run.read("position", frame),
        director=run.read("director", frame),
        rods=run.rods,
        units=run.units,
        wall=run.wall,
        title=title,
        thickness=thickness,
    )
