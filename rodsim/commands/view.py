"""``rodsim view``."""

from pathlib import Path

import click

from rodsim.commands.common import output_argument, prepare_numba, say, written_path


# fmt: off
@click.command()
@output_argument
@click.option("-o", "--output", "page", type=click.Path(path_type=Path, dir_okay=False),
              help="Page to write, .html; by default OUT.html. One that exists is replaced.")
@click.option("-n", "--frames", type=click.IntRange(1, 10_000),
              help="How many frames of the run; by default all, of long runs 200.")
@click.option("--radius", type=click.FloatRange(0, min_open=True), metavar="LENGTH",
              help="Of the tubes; by default the radius of the cylinder that moves the fluid as "
              "the rod does, 0.607 epsilon (algebraic7) or 0.368 epsilon.")
@click.option("--colour", "--color", default="rod", show_default=True,
              type=click.Choice(("rod", "time", "curvature", "twist")),
              help="What colours mean at first; the page can change it.")
@click.option("-q", "--quiet", is_flag=True, help="No message.")
def view(output, page, frames, radius, colour, quiet):
    # fmt: on
    """Write a run as one page for any browser, without a network: rods to turn, over time.

    Needs rodsim[view].
    """
    page = written_path(page or output.with_suffix(".html"), (".html",))
    there = page.exists()
    prepare_numba()
    from rodsim.export.page import write_page
    from rodsim.output import open_trajectory

    with open_trajectory(output) as run:
        drawn = write_page(run, page, frames=frames, radius=radius, colour=colour)
    if not quiet:
        size = page.stat().st_size / 1e6
        say(f"wrote {page}, {drawn} frames, {size:.1f} MB"
            f"{', in place of an earlier one' if there else ''}")
