"""``rodsim flow``."""

from pathlib import Path

import click

from rodsim.commands.common import (
    STILLS,
    device_option,
    output_argument,
    prepare_numba,
    say,
    say_written,
    threads_option,
    warn,
    written_path,
)
from rodsim.commands.sheet import sheet_options

GRID_HELP = """\b
Grids (sizes follow the rods, with a margin, unless given):
  plane          the plane in which the rods are largest
  plane:yz       parallel to y and z, through the middle;
                 plane:yz@0.5 at x = 0.5
  line:z         along z, through the middle; line:z@0.5,2 at x = 0.5, y = 2
  box            all around the rods
  0,-2:2:41,-3:3:61
                 x = 0, 41 values of y from -2 to 2, 61 of z from -3 to 3
"""
SEEDS = {1: 40, 2: 16, 3: 8}  # tracers along the longest side of a line, a plane, a box

TRUSTED = 0.1  # of epsilon: what tracers may be off by in one frame without a warning


# fmt: off
@click.command(epilog=GRID_HELP)
@output_argument
@click.option("--at", type=float, metavar="T",
              help="Time; the frame nearest to it is taken. By default the last one, for tracers "
              "the first.")
@click.option("--grid", "grid_text", default="plane", show_default=True, metavar="GRID",
              help="Points at which the flow is wanted, or where tracers start; see "
              "below.")
@click.option("--resolution", type=click.IntRange(2, 100_000), metavar="N",
              help="Points along the longest side of the grid.")
@click.option("-o", "--output", "path", type=click.Path(path_type=Path, dir_okay=False),
              help="File to write: a picture .png .pdf .svg, or numbers .npz .csv .vti, of "
              "tracers .vtkhdf; by default OUT_flow.png. One that exists is replaced.")
@click.option("--colour", "--color", type=click.Choice(("speed", "pressure")), default="speed",
              show_default=True, help="What the colour in a plane means.")
@click.option("--arrows", is_flag=True,
              help="Arrows instead of stream lines, of equal length: they show directions.")
@click.option("--log", is_flag=True,
              help="Logarithmic colours of the speed: what is slow, far away, is seen too.")
@click.option("--tracers", is_flag=True,
              help="Follow tracers from the points of the grid, from --at on.")
@click.option("--until", type=float, metavar="T",
              help="How long to follow tracers; by default to the end.")
@click.option("--raw", is_flag=True,
              help="Use the stored state as it is; its fastest modes are let settle "
              "otherwise.")
@sheet_options
@threads_option
@device_option
@click.option("-q", "--quiet", is_flag=True, help="No progress, no message.")
def flow(output, at, grid_text, resolution, path, colour, arrows, log, tracers, until, raw, threads,
         device, size, dpi, title, quiet):
    # fmt: on
    """Compute velocity and pressure of the fluid around the rods of a stored run.

    From the file alone, at any of its frames; or the paths of tracers through its frames.
    """
    from rodsim.export.flow import FLOW, TRACERS

    default = output.with_name(f"{output.stem}_{'tracers' if tracers else 'flow'}.png")
    path = written_path(path or default, (*STILLS, *(TRACERS if tracers else FLOW)))
    for_flow = {"--arrows": arrows, "--log": log, "--raw": raw}
    _refuse_unused(tracers, for_flow, {"--until": until is not None})
    there = path.exists()
    prepare_numba()
    from rodsim.analysis.replay import Replay
    from rodsim.compiled.threads import threads_for
    from rodsim.output import open_trajectory
    from rodsim.run.warmup import ensure_compiled

    sheet = size, dpi, title
    with open_trajectory(output) as run, threads_for(10**12, threads):
        replay = Replay(run, device)
        ensure_compiled(replay.scene, lambda line: quiet or say(line), flow=True)
        if tracers:
            _tracers(replay, at, until, grid_text, resolution, path, sheet, quiet)
        else:
            drawn = colour, arrows, log
            _flow(replay, at, grid_text, resolution, path, drawn, raw, sheet, quiet)
    say_written(path, there, quiet)


def _refuse_unused(tracers, for_flow, for_tracers):
    """Raise UsageError for an option that would change nothing."""
    for option, given in (for_flow if tracers else for_tracers).items():
        if given:
            from rodsim.errors import UsageError

            raise UsageError(f"{option} is {'not for' if tracers else 'only for'} --tracers")


def _flow(replay, at, grid_text, resolution, path, drawn, raw, sheet, quiet):
    from rodsim.analysis.flow import flow_at
    from rodsim.analysis.grid import make_grid

    run = replay.run
    frame = _frame(run, at, run.frames - 1, quiet)
    grid = make_grid(grid_text, _points(run, frame), resolution, floor=run.wall)
    flow = flow_at(replay, frame, grid, raw)
    if replay.without_pressure and not quiet:
        names = ", ".join(replay.without_pressure)
        click.echo(f"pressure: without that of {names}, which is not known", err=True)
    if path.suffix in STILLS:
        from rodsim.plotting.flow_pictures import plot_flow
        from rodsim.plotting.style import Sheet

        plot_flow(flow, _drawn(run, frame), path, *drawn, Sheet(*sheet))
    else:
        from rodsim.export.flow import export_flow

        export_flow(flow, run.units, path)


def _tracers(replay, at, until, grid_text, resolution, path, sheet, quiet):
    from rodsim.analysis.flow import tracer_paths
    from rodsim.analysis.grid import make_grid
    from rodsim.progress import make_progress

    run = replay.run
    first = _frame(run, at, 0, quiet)
    last = _frame(run, until, run.frames - 1, quiet)
    if last <= first:
        from rodsim.errors import UsageError

        raise UsageError("tracers need a time --until after the one --at which they start")
    grid = make_grid(grid_text, _points(run, first), resolution, SEEDS, run.wall)
    seeds = grid.points[grid.points[:, 2] >= replay.scene.floor]
    if len(seeds) < len(grid.points) and not quiet:
        click.echo(f"{len(grid.points) - len(seeds)} tracers would start below the wall", err=True)
    with make_progress("tracers", quiet) as progress:
        paths = tracer_paths(replay, seeds, first, last, progress)
    _say_miss(run, replay, paths, quiet)
    if path.suffix in STILLS:
        from rodsim.plotting.flow_pictures import plot_paths
        from rodsim.plotting.style import Sheet

        plot_paths(paths.time, paths.position, _drawn(run, last), path, Sheet(*sheet))
    else:
        from rodsim.export.flow import export_tracers

        export_tracers(paths.time, paths.position, run.units, path)


def _points(run, frame):
    """Return the points of rods and of the surfaces of bodies, which a grid is to hold."""
    import numpy as np

    return np.concatenate([run.read("position", frame), run.surfaces(frame)])


def _say_miss(run, replay, paths, quiet):
    """Say how far the paths can be trusted; warn where that is not far."""
    worst = int(paths.miss.argmax())
    begin, end = paths.time[worst : worst + 2]
    text = (
        f"the rods' own points, followed in the same way, miss their stored places by up to "
        f"{paths.miss[worst]:.2g} {run.units['length']} a frame (between t = {begin:g} and {end:g})"
    )
    if paths.miss[worst] > TRUSTED * replay.scene.epsilon:
        warn(f"{text}: start later (--at), or run with a shorter output.interval")
    elif not quiet:
        say(text)


def _frame(run, asked, default, quiet):
    """Return the frame nearest to the time asked for; say so if it is another time."""
    from rodsim.analysis.frames import nearest_frame
    from rodsim.errors import FileError

    if run.frames == 0:
        raise FileError(f"{run.path}: has no frames yet ({run.status})")
    if asked is None:
        return default
    frame = nearest_frame(run.time, asked, run.units["time"])
    if run.time[frame] != asked and not quiet:
        unit = run.units["time"]
        say(f"t = {run.time[frame]:g} {unit} is the frame nearest to {asked:g}")
    return frame


def _drawn(run, frame):
    from rodsim.plotting.flow_pictures import scene_to_draw
    from rodsim.plotting.look import thickness
    from rodsim.plotting.pictures import read_title

    return scene_to_draw(run, frame, read_title(run), thickness(run))
