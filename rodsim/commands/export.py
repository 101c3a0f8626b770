"""``rodsim export``."""

from pathlib import Path

import click

from rodsim.commands.common import output_argument, say_written, written_path


# fmt: off
@click.command()
@output_argument
@click.option("-o", "--output", "path", required=True,
              type=click.Path(path_type=Path, dir_okay=False),
              help="File to write: .vtkhdf (ParaView), .csv, .npz, or .py: a state of ParaView "
              "with tubes and bodies. One that exists is replaced.")
@click.option("--every", type=click.IntRange(min=1), default=1, show_default=True,
              help="Only every n-th frame.")
@click.option("--tracers", is_flag=True, help="The fluid markers instead of the rods.")
@click.option("--radius", type=click.FloatRange(0, min_open=True), metavar="LENGTH",
              help="Of the tubes in ParaView; by default the radius of the cylinder that moves "
              "the fluid as the rod does, 0.607 epsilon (algebraic7) or 0.368 epsilon.")
@click.option("-q", "--quiet", is_flag=True, help="No progress, no message.")
def export(output, path, every, tracers, radius, quiet):
    # fmt: on
    """Write a run for other programs: positions, triads and all stored fields over time."""
    from rodsim.export.run import SUFFIXES, export_run
    from rodsim.output import open_trajectory
    from rodsim.progress import make_progress

    written_path(path, SUFFIXES)
    there = path.exists()
    with open_trajectory(output) as run, make_progress(path.name, quiet) as progress:
        export_run(run, path, every=every, tracers=tracers, radius=radius, progress=progress)
    say_written(path, there, quiet)
