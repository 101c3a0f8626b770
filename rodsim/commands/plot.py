"""``rodsim plot``."""

from pathlib import Path

import click

from rodsim.commands.common import (
    STILLS,
    prepare_numba,
    say_written,
    written_path,
)
from rodsim.commands.sheet import sheet_options

MOVIES = (".gif", ".mp4")
WHAT = ("shapes", "energy", "curvature", "twist", "speed")  # pictures of one run


# fmt: off
@click.command()
@click.argument("outputs", metavar="OUT.h5...", nargs=-1, required=True,
                type=click.Path(path_type=Path))
@click.option("-o", "--output", "picture", type=click.Path(path_type=Path, dir_okay=False),
              help="Picture to write: .png .pdf .svg, of shapes also a movie, .gif .mp4; "
              "by default OUT.png. One that exists is replaced.")
@click.option("-w", "--what", default="shapes", show_default=True, metavar="NAME",
              help="shapes of the rods; energy or speed over time; curvature or twist along "
              "the rods over time; or what rodsim measure knows, over time, also of several runs "
              "in one picture: -w writhe, -w tail.speed,power.")
@click.option("-n", "--frames", type=click.IntRange(1, 100_000),
              help="How many frames of the run; by default 6, for a movie all.")
@click.option("--at", type=float, multiple=True, metavar="T",
              help="Draw the shapes nearest to this time (again for more times).")
@click.option("--view", default="auto", show_default=True, metavar="VIEW",
              help="3d, or straight at a plane: xy, yz, xz, zy, ...")
@click.option("--style", "kind", type=click.Choice(("tube", "ribbon", "line")),
              help="tube (with a white stripe along D1) in space, line in a plane, ribbon "
              "(along D1, its back darker).")
@click.option("--colour", "--color", type=click.Choice(("time", "rod", "curvature", "twist")),
              help="What colours mean; by default rod where there are two to seven and times lie "
              "side by side, else time.")
@click.option("--range", "limits", nargs=2, type=float, metavar="LOW HIGH",
              help="Ends of the colours of curvature or twist; by default what is seen, of the "
              "first frame only where it is not far off the others.")
@click.option("--radius", type=click.FloatRange(0, min_open=True), metavar="LENGTH",
              help="Of tubes; by default that of the cylinder that moves the fluid as the rod "
              "does, 0.607 epsilon (algebraic7) or 0.368 epsilon.")
@click.option("--directors", is_flag=True,
              help="Draw D1 (red) and D2 (blue) of the triads as arrows on the shapes.")
@click.option("--overlay", is_flag=True, help="Draw all times over each other, not side by side.")
@click.option("--log", is_flag=True, help="Quantities over time on a logarithmic axis.")
@click.option("--fps", type=click.FloatRange(0.1, 120), default=20, show_default=True,
              help="Frames a second of a movie.")
@click.option("--turn", type=float, metavar="DEGREES",
              help="Turn the scene by so much in the course of a movie.")
@sheet_options
@click.option("-q", "--quiet", is_flag=True, help="No progress, no message.")
def plot(outputs, picture, what, frames, at, view, kind, colour, limits, radius, directors,
         overlay, log, fps, turn, size, dpi, title, quiet):
    # fmt: on
    """Draw a run: its shapes, as a still or a movie, or quantities over time, also of several runs.

    Needs rodsim[plot].
    """
    output = outputs[0]
    movies = MOVIES if what == "shapes" else ()
    picture = written_path(picture or output.with_suffix(".png"), (*STILLS, *movies))
    over_time = len(outputs) > 1 or what not in ("shapes", "curvature", "twist")
    _refuse_unused(
        ("--log", log and (what == "energy" or not over_time), "for a quantity over time"),
        ("--turn", turn is not None and picture.suffix not in MOVIES, "for a movie"),
        ("--range", limits and not _coloured(what, colour), "for colours of curvature or twist"),
        ("--radius", radius and (what != "shapes" or kind == "line"), "for tubes and ribbons"),
    )
    there = picture.exists()
    prepare_numba()
    from rodsim.plotting import pictures
    from rodsim.plotting.style import Sheet

    sheet = Sheet(size, dpi, title)
    if what == "shapes" and len(outputs) == 1:
        if turn and view == "auto":
            view = "3d"
        look = pictures.Look(view, kind, colour or "", directors, radius, limits, overlay)
        _draw_shapes(output, picture, look, frames, at, (fps, turn or 0.0), sheet, quiet)
    elif len(outputs) > 1 or what not in WHAT:
        pictures.plot_measures(outputs, picture, what.split(","), sheet, log)
    elif what == "energy":
        pictures.plot_energy(output, picture, sheet)
    elif what == "speed":
        pictures.plot_speed(output, picture, sheet, log)
    else:
        pictures.plot_kymograph(output, picture, what, limits, sheet)
    say_written(picture, there, quiet)


def _draw_shapes(output, picture, look, frames, at, film, sheet, quiet):
    """Draw a still or a movie."""
    from rodsim.plotting import pictures

    if picture.suffix not in MOVIES:
        pictures.plot_shapes(output, picture, look, frames=frames, at=at, sheet=sheet)
        return
    from rodsim.plotting.movie import Film
    from rodsim.progress import make_progress

    with make_progress(picture.name, quiet) as progress:
        pictures.plot_movie(
            output, picture, look, frames=frames, film=Film(*film), progress=progress, sheet=sheet
        )


def _coloured(what, colour):
    return what in ("curvature", "twist") or (what == "shapes" and colour in ("curvature", "twist"))


def _refuse_unused(*options):
    """Raise UsageError for an option that would change nothing."""
    for name, unused, purpose in options:
        if unused:
            from rodsim.errors import UsageError

            raise UsageError(f"{name} is {purpose}: nothing here has that")
