"""From an output file to its pictures: reads what is to be seen, chooses colours, draws."""

from __future__ import annotations

import numpy as np

from rodsim.analysis.energy import energy_table
from rodsim.analysis.frames import nearest_frame, spread_frames
from rodsim.analysis.measuring import over_time, pick
from rodsim.analysis.strain import bend, is_flat, strain_twist
from rodsim.errors import FileError, UsageError
from rodsim.output import open_trajectory
from rodsim.plotting import style
from rodsim.plotting.camera import make_camera
from rodsim.plotting.curves import plot_curves, run_names
from rodsim.plotting.energy import plot_energies
from rodsim.plotting.movie import write_movie
from rodsim.plotting.over_time import draw_kymograph, draw_speeds, limits_of
from rodsim.plotting.rod import KINDS
from rodsim.plotting.shapes import Shapes, draw_overlay, draw_panels

THICKNESS = 0.03  # of the length of the longest rod
ARROW = 0.06  # likewise, of D^1 and D^2
PANELS = 6
OF_SEVERAL = {"energy": "elastic_energy"}  # of several runs, one curve each


def read_title(run) -> str:
    """Return the title of the case in a file, or an empty text."""
    try:
        return str(run.case_data().get("title", ""))
    except FileError:
        return ""


def thickness(run) -> float:
    """Return how thick rods are drawn, a length."""
    return THICKNESS * max(rod.spacing * rod.count for rod in run.rods)


def surfaces_of(run, frames):
    """Return the surfaces of bodies (F, S, 3) in some frames and their triangles, or None, None."""
    if not run.bodies:
        return None, None
    return np.array([run.surfaces(frame) for frame in frames]), run.triangles


def plot_shapes(path, out, *, frames, at, view, kind, colour, overlay, directors=False):
    """Draw the shapes of a run: ``frames`` of them, or those nearest to the times ``at``."""
    with open_trajectory(path) as run:
        chosen = _frames(run, frames or PANELS, at)
        camera, shapes, key = _look(run, chosen, view, kind, colour, directors)
        title = read_title(run)
    draw = draw_overlay if overlay else draw_panels
    style.save(draw(shapes, camera, title, key if overlay or colour != "time" else None), out)


def plot_movie(path, out, *, frames, view, kind, colour, fps, progress, directors=False):
    """Write a movie of a run, of all its frames or of ``frames`` of them."""
    with open_trajectory(path) as run:
        chosen = _frames(run, frames or run.frames, ())
        camera, shapes, _ = _look(run, chosen, view, kind, colour, directors)
        title = read_title(run)
    write_movie(out, shapes, camera, fps, title, progress)


def plot_energy(path, out):
    """Draw the energies of a run over time."""
    plot_energies(energy_table(path), out)


def plot_speed(path, out):
    """Draw the speed of a run's points over time, from the loads that its frames exert."""
    from rodsim.analysis.replay import Replay  # compiles: only this picture waits for it

    with open_trajectory(path) as run:
        replay = Replay(run)
        velocity = np.array([replay.settled_velocity(frame) for frame in range(run.frames)])
        units, time = run.units, run.time
    figure = style.new_figure(6.4, 4.2)
    unit = f"{units['length']} {units['time']}^-1"
    draw_speeds(figure.add_subplot(), time, velocity, unit, units["time"])
    style.save(figure, out)


def plot_measures(paths, out, names):
    """Draw quantities of one run or several over time, see :mod:`rodsim.analysis.measures`."""
    if alone := {"shapes", "curvature"} & {*names}:
        raise UsageError(f"-w {alone.pop()}: is a picture of one run, alone")
    tables, units = {}, {}
    for path, name in zip(paths, run_names(paths), strict=True):
        if name in tables:
            raise UsageError(f"{path}: is given twice")
        with open_trajectory(path) as run:
            tables[name] = over_time(run, pick(run, [OF_SEVERAL.get(n, n) for n in names]))
        units |= {c.quantity: c.unit for c in tables[name].columns}
        if any(units[c.quantity] != c.unit for t in tables.values() for c in t.columns):
            raise UsageError(f"{path}: is in other units than {paths[0]}")
    plot_curves(tables, out)


def plot_kymograph(path, out, quantity):
    """Draw ``curvature`` or ``twist`` along every rod over time."""
    with open_trajectory(path) as run:
        _need_frames(run)
        values = _along(run, quantity, range(run.frames))
        rods, time, units = run.rods, run.time, run.units
    if len(time) < 2:
        raise UsageError(f"{path}: has one frame; a picture over time needs two")
    figure = style.new_figure(6.6, 0.6 + 3.0 * len(rods))
    axes = figure.subplots(len(rods), 1, squeeze=False, sharex=True)[:, 0]
    limits = limits_of(np.concatenate([value.ravel() for value in values]))
    for axis, rod, value in zip(axes, rods, values, strict=True):
        s = (np.arange(value.shape[1]) + 0.5) * rod.spacing
        text = style.label(quantity, f"{units['length']}^-1")
        draw_kymograph(axis, time, s, value, limits, text)
        axis.set_ylabel(style.label(f"s along {rod.name}", units["length"]))
    axes[-1].set_xlabel(style.label("time", units["time"]))
    style.save(figure, out)


def _need_frames(run):
    if run.frames == 0:
        raise FileError(f"{run.path}: has no frames yet ({run.status})")


def _frames(run, wanted, at):
    _need_frames(run)
    if at:
        return [nearest_frame(run.time, time, run.units["time"]) for time in at]
    return spread_frames(run.frames, wanted)


def _look(run, chosen, view, kind, colour, directors):
    """Return the camera, the shapes and the key of the colours for some frames."""
    position = np.array([run.read("position", frame) for frame in chosen])
    surfaces, triangles = surfaces_of(run, chosen)
    seen = position if surfaces is None else np.concatenate([position, surfaces], axis=1)
    camera = make_camera(view, seen, upright=run.wall is not None)
    line = camera.flat or directors or "director" not in run.fields
    kind = kind or ("line" if line else "tube")
    if kind not in KINDS:
        raise UsageError(f"style must be one of {', '.join(KINDS)}, not {kind!r}")
    director = None
    if kind != "line" or directors:
        director = np.array([run.read("director", frame) for frame in chosen])
    colours, key = _colours(run, chosen, colour)
    tracers = np.zeros((len(chosen), 0, 3))
    if "tracers" in run.fields:
        tracers = np.array([run.read("tracers", frame) for frame in chosen])
    shapes = Shapes(
        run.time[chosen], position, director, run.rods, colours, tracers, run.units,
        thickness(run), kind, run.wall, directors * ARROW / THICKNESS * thickness(run),
        surfaces, triangles,
    )  # fmt: skip
    return camera, shapes, key


def _colours(run, chosen, colour):
    """Return the colours of each frame and rod, and what the colours mean."""
    colours = style.colour_map(style.COLOURS)
    if colour == "time":
        low, high = run.time[chosen[0]], run.time[chosen[-1]]
        share = (run.time[chosen] - low) / ((high - low) or 1.0)
        key = colours, low, high, style.label("time", run.units["time"])
        return [[colours(float(x))] * len(run.rods) for x in share], key
    values = _along(run, colour, chosen)
    low, high = limits_of(np.concatenate([value.ravel() for value in values]))
    key = colours, low, high, style.label(colour, f"{run.units['length']}^-1")
    share = [(value - low) / (high - low) for value in values]
    return [[colours(of_rod[frame]) for of_rod in share] for frame in range(len(chosen))], key


def _along(run, quantity, frames):
    """Return the curvature or twist of the segments of each rod in some frames, (F, S) each.

    Curvature has a sign only where all rods of all frames lie in a plane.
    """
    triads, strains = np.array([run.read("director", frame) for frame in frames]), []
    for rod in run.rods:
        nodes = triads[:, rod.first : rod.first + rod.count]
        strains.append(strain_twist(nodes, rod.spacing, rod.closed))
    if quantity == "twist":
        return [strain[..., 2] for strain in strains]
    flat = all(is_flat(strain) for strain in strains)
    return [strain[..., 0] if flat else bend(strain) for strain in strains]
