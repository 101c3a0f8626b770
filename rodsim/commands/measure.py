"""``rodsim measure``."""

from pathlib import Path

import click

from rodsim.commands.common import STILLS, output_argument, say, say_written, written_path
from rodsim.commands.sheet import sheet_options


# fmt: off
@click.command()
@output_argument
@click.argument("names", metavar="[NAME]...", nargs=-1)
@click.option("--measure", "own", multiple=True, metavar="FILE.py:FUNCTION",
              help="A quantity of your own, a function of a rod at a frame.")
@click.option("--rod", "rods", multiple=True, metavar="ROD",
              help="Only of this rod (again for more).")
@click.option("--every", type=click.IntRange(min=1), default=1, show_default=True,
              help="Only every n-th frame.")
@click.option("--period", metavar="EXPRESSION",
              help="One number of each for the whole periods after the first, e.g. '2*pi/sigma', "
              "in place of the table.")
@click.option("--csv", "csv_path", type=click.Path(path_type=Path, dir_okay=False),
              help="Write the table to a file as well.")
@click.option("--plot", "plot_path", type=click.Path(path_type=Path, dir_okay=False),
              help="Draw it over time (needs rodsim[plot]).")
@sheet_options
@click.option("-q", "--quiet", is_flag=True, help="No progress, no message.")
def measure(output, names, own, rods, every, period, csv_path, plot_path, size, dpi,
            title, quiet):
    # fmt: on
    """Measure quantities over time, such as speed, writhe, power: of each rod, from the file.

    NAME is that of a quantity, of all rods that have it, or ROD.NAME. Without a name: the list.
    """
    from rodsim.analysis import measuring
    from rodsim.output import open_trajectory
    from rodsim.progress import make_progress

    _check(csv_path, plot_path, names or own, period)
    with open_trajectory(output) as run:
        if not (names or own):
            say(_listed(run, measuring.available(run)), err=False)
            return
        picked = measuring.pick(run, (*names, *own), rods)
        if period:
            say(_numbers(run, picked, period), err=False)
            return
        with make_progress(output.name, quiet) as progress:
            table = measuring.over_time(run, picked, every, progress)
    say(table.text(), err=False)
    if csv_path:
        there = csv_path.exists()
        table.write_csv(csv_path)
        say_written(csv_path, there, quiet)
    if plot_path:
        from rodsim.plotting.curves import plot_curves
        from rodsim.plotting.style import Sheet

        there = plot_path.exists()
        plot_curves({"": table}, plot_path, Sheet(size, dpi, title))
        say_written(plot_path, there, quiet)


def _check(csv_path, plot_path, asked, period):
    """Refuse what cannot be done before anything is read."""
    from rodsim.errors import UsageError

    if csv_path:
        written_path(csv_path, (".csv",))
    if plot_path:
        written_path(plot_path, STILLS)
    if (csv_path or plot_path or period) and not asked:
        raise UsageError("name what to measure; rodsim measure OUT.h5 alone lists what there is")
    if period and (csv_path or plot_path):
        raise UsageError("--period gives single numbers: leave out --csv and --plot")


def _listed(run, measures) -> str:
    """Return the list of quantities: name, unit, what it is; by what they are of."""
    units = [m.unit_in(run.units) for m in measures]
    wide, wider = (max(map(len, texts)) for texts in ([m.name for m in measures], units))
    lines = []
    for per in dict.fromkeys(m.per for m in measures):
        lines.append(f"of the whole {per}:" if per == "scene" else f"of each {per}:")
        for m, unit in zip(measures, units, strict=True):
            if m.per == per:
                only = f" ({m.rods} rods)" if m.rods else ""
                lines.append(f"  {m.name:{wide}}  {unit:{wider}}  {m.about}{only}")
    return "\n".join(lines)


def _numbers(run, picked, period) -> str:
    """Return a line for each number: name, value, unit, what it is."""
    from rodsim.analysis.measuring import of_run
    from rodsim.analysis.periods import period_of

    length = period_of(period, run.case_data().get("parameters", {}))
    numbers = of_run(run, picked, length)
    heads = [(c, p.measure.whole) for p in picked for c in p.columns(run.units)]
    wide = max(map(len, numbers))
    return "\n".join(
        f"{column.name:{wide}}  {numbers[column.name]:13.6e}  {column.unit}  ({whole})"
        for column, whole in heads
    )
