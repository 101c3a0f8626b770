"""``rodsim plot``."""

from pathlib import Path

import click

from rodsim.commands.common import (
    STILLS,
    prepare_numba,
    say_written,
    written_path,
)

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
              help="tube (with a stripe along D1) in space, line in a plane, ribbon "
              "(along D1).")
@click.option("--colour", "--color", type=click.Choice(("time", "curvature", "twist")),
              default="time", show_default=True, help="What colours mean.")
@click.option("--directors", is_flag=True,
              help="Draw D1 (red) and D2 (blue) of the triads as arrows on the shapes.")
@click.option("--overlay", is_flag=True, help="Draw all times over each other, not side by side.")
@click.option("--fps", type=click.FloatRange(0.1, 120), default=20, show_default=True,
              help="Frames a second of a movie.")
@click.option("-q", "--quiet", is_flag=True, help="No progress, no message.")
def plot(outputs, picture, what, frames, at, view, kind, colour, directors, overlay,
         fps, quiet):
    # fmt: on
    """Draw a run: its shapes, as a still or a movie, or quantities over time, also of several runs.

    Needs rodsim[plot].
    """
    output = outputs[0]
    movies = MOVIES if what == "shapes" else ()
    picture = written_path(picture or output.with_suffix(".png"), (*STILLS, *movies))
    there = picture.exists()
    prepare_numba()
    from rodsim.plotting import pictures

    look = {"frames": frames, "view": view, "kind": kind, "colour": colour, "directors": directors}
    if len(outputs) > 1 or what not in WHAT:
        pictures.plot_measures(outputs, picture, what.split(","))
    elif picture.suffix in MOVIES:
        from rodsim.progress import make_progress

        with make_progress(picture.name, quiet) as progress:
            pictures.plot_movie(output, picture, **look, fps=fps, progress=progress)
    elif what == "shapes":
        pictures.plot_shapes(output, picture, **look, at=at, overlay=overlay)
    elif what == "energy":
        pictures.plot_energy(output, picture)
    elif what == "speed":
        pictures.plot_speed(output, picture)
    else:
        pictures.plot_kymograph(output, picture, what)
    say_written(picture, there, quiet)
