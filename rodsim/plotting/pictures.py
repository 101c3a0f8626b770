"""From an output file to its pictures: reads what is to be seen, chooses colours, draws."""

from __future__ import annotations

import numpy as np

from rodsim.analysis.energy import energy_table
from rodsim.analysis.frames import nearest_frame, spread_frames
from rodsim.analysis.measuring import over_time, pick
from rodsim.errors import FileError, UsageError
from rodsim.output import open_trajectory
from rodsim.plotting import colours, style
from rodsim.plotting.curves import plot_curves, run_names
from rodsim.plotting.energy import plot_energies
from rodsim.plotting.look import Look, along
from rodsim.plotting.movie import write_movie
from rodsim.plotting.over_time import draw_kymograph, draw_speeds
from rodsim.plotting.shapes import draw_overlay, draw_panels

PANELS = 6
OF_SEVERAL = {"energy": "elastic_energy"}  # of several runs, one curve each


def read_title(run) -> str:
    """Return the title of the case in a file, or an empty text."""
    try:
        return str(run.case_data().get("title", ""))
    except FileError:
        return ""


@style.styled
def plot_shapes(path, out, look: Look, *, frames=None, at=(), sheet=style.PLAIN):
    """Draw the shapes of a run: ``frames`` of them, or those nearest to the times ``at``."""
    with open_trajectory(path) as run:
        camera, shapes, key = look.of(run, _frames(run, frames or PANELS, at))
        title = read_title(run)
    draw = draw_overlay if look.overlay else draw_panels
    sheet.save(draw(shapes, camera, title, key, sheet), out)


@style.styled
def plot_movie(path, out, look: Look, *, frames=None, film, progress, sheet=style.PLAIN):
    """Write a movie of a run, of all its frames or of ``frames`` of them.

    ``film`` : :class:`~rodsim.plotting.movie.Film`.
    """
    with open_trajectory(path) as run:
        camera, shapes, key = look.of(run, _frames(run, frames or run.frames, ()))
        title = read_title(run)
    write_movie(out, shapes, camera, key, film, title, sheet, progress)


@style.styled
def plot_energy(path, out, sheet=style.PLAIN):
    """Draw the energies of a run over time."""
    plot_energies(energy_table(path), out, sheet)


@style.styled
def plot_speed(path, out, sheet=style.PLAIN, log=False):
    """Draw the speed of a run's points over time, from the loads that its frames exert."""
    from rodsim.analysis.replay import Replay  # compiles: only this picture waits for it

    with open_trajectory(path) as run:
        replay = Replay(run)
        velocity = np.array([replay.settled_velocity(frame) for frame in range(run.frames)])
        units, time = run.units, run.time
    figure = sheet.figure(6.4, 4.2)
    unit = f"{units['length']} {units['time']}^-1"
    draw_speeds(figure.add_subplot(), time, velocity, unit, units["time"], log)
    sheet.save(figure, out)


@style.styled
def plot_measures(paths, out, names, sheet=style.PLAIN, log=False):
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
    plot_curves(tables, out, sheet, log)


@style.styled
def plot_kymograph(path, out, quantity, limits=None, sheet=style.PLAIN):
    """Draw ``curvature`` or ``twist`` along every rod over time."""
    with open_trajectory(path) as run:
        _need_frames(run)
        values = along(run, quantity, range(run.frames))
        rods, time, units = run.rods, run.time, run.units
    if len(time) < 2:
        raise UsageError(f"{path}: has one frame; a picture over time needs two")
    figure = sheet.figure(6.6, 0.6 + 3.0 * len(rods))
    axes = figure.subplots(len(rods), 1, squeeze=False, sharex=True)[:, 0]
    unit = f"{units['length']}^-1"
    scale = colours.scale_of(values, quantity, unit, limits, paper=False)
    for axis, rod, value in zip(axes, rods, values, strict=True):
        s = (np.arange(value.shape[1]) + 0.5) * rod.spacing
        draw_kymograph(axis, time, s, value, scale)
        axis.set_ylabel(style.label(f"s along {rod.name}", units["length"]))
    axes[-1].set_xlabel(style.label("time", units["time"]))
    scale.draw(figure, list(axes))
    sheet.save(figure, out)


def _need_frames(run):
    if run.frames == 0:
        raise FileError(f"{run.path}: has no frames yet ({run.status})")


def _frames(run, wanted, at):
    _need_frames(run)
    if at:
        return [nearest_frame(run.time, time, run.units["time"]) for time in at]
    return spread_frames(run.frames, wanted)
