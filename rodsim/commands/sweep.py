"""``rodsim sweep``."""

import shlex
import signal
from contextlib import contextmanager, suppress
from pathlib import Path

import click

from rodsim.commands.common import (
    STILLS,
    case_argument,
    prepare_numba,
    say,
    set_option,
    warn,
    written_path,
)
from rodsim.commands.sheet import sheet_options

_FILE, _FOLDER = (click.Path(path_type=Path, dir_okay=d, file_okay=not d) for d in (False, True))


# fmt: off
@click.command()
@case_argument
@set_option
@click.option("--table", type=_FILE, metavar="FILE.csv",
              help="One run for each row; the first row names the keys.")
@click.option("-o", "--output", "folder", type=_FOLDER, default="sweep", show_default=True,
              help="Folder for the runs and summary.csv.")
@click.option("-j", "--jobs", type=click.IntRange(1, 1024), metavar="N",
              help="Runs at once on this machine; by default as many as fill it.")
@click.option("--threads", type=click.IntRange(1, 1024), metavar="N",
              help="Threads of each run; by default what is left when -j runs share the machine.")
@click.option("--scheduler", metavar="ADDRESS",
              help="Use the workers of a running Dask scheduler, e.g. tcp://node:8786.")
@click.option("--isolate", is_flag=True,
              help="A process for each run, not one for many: slower where runs are short.")
@click.option("--list", "only_list", is_flag=True,
              help="Print the commands that are left to do, one per line, and run none.")
@click.option("--period", metavar="EXPRESSION",
              help="Measure speed over whole periods after the first, e.g. '2*pi/sigma'.")
@click.option("--measure", "measures", multiple=True, metavar="NAME,...",
              help="More columns: quantities of rodsim measure, writhe or tail.speed or "
              "my.py:function.")
@click.option("--reference", type=_FILE, metavar="OUT.h5",
              help="Give the largest distance from this output, at the end, as the error.")
@click.option("--plot", "plots", type=(str, str, _FILE), multiple=True, metavar="X Y FILE",
              help="Draw one column over another (needs rodsim[plot]).")
@click.option("--map", "maps", type=(str, str, str, _FILE), multiple=True, metavar="X Y Z FILE",
              help="Draw column Z as colours over two keys, X and Y.")
@click.option("--log", type=click.Choice(("x", "y", "xy", "none")),
              help="Axes of these pictures that are logarithmic; by default those of positive "
              "numbers over two decades or more.")
@click.option("--rest", is_flag=True, help="Find states at rest instead, as rodsim rest does.")
@click.option("--saddle", is_flag=True, help="With --rest: stay at states that are not stable.")
@click.option("--from", "origin", metavar="previous|OUT.h5",
              help="With --rest: start each from the rest before it, or all from an output.")
@sheet_options
@click.option("-q", "--quiet", is_flag=True, help="No progress.")
def sweep(case_path, overrides, table, folder, jobs, threads, scheduler, isolate, only_list,
          period, measures, reference, plots, maps, log, rest, saddle, origin, size, dpi, title,
          quiet):
    # fmt: on
    """Run a case for many values: --set KEY=[A,B,C] runs over a list, here or on a cluster.

    Each run has a folder of its own. The same command again goes on: what has finished is skipped,
    what was stopped is resumed.
    """
    from rodsim.sweep.plan import make_plan
    from rodsim.sweep.series import check_grid
    from rodsim.sweep.standing import DONE
    from rodsim.sweep.summary import Summary
    from rodsim.sweep.work import command

    chained = _chained(rest, saddle, origin, scheduler)
    plan = make_plan(case_path, overrides, table, folder, numbered=chained)
    if rest:
        from rodsim.sweep.rests import as_rests

        plan = as_rests(plan, origin, ("--saddle",) * saddle)
    columns = tuple(name.strip() for text in measures for name in text.split(","))
    summary = Summary(plan, period, reference, columns)
    pictures = [([*map(summary.column, names)], path) for *names, path in (*plots, *maps)]
    for names, path in pictures:
        written_path(path, STILLS)
        if len(names) == 3:
            check_grid(summary, *names[:2])
    left = [run for run in plan.runs if summary.rows[run.name]["status"] not in DONE]
    _say_what_is_anew(left, summary)
    if only_list:
        for run in left:
            status = summary.rows[run.name]["status"]
            if status != "running":
                run.prepare()
                click.echo(shlex.join(command(run, status)))
        return
    table_path = folder / "summary.csv"
    try:
        if left:
            _run(left, summary, table_path, (jobs, threads, scheduler, isolate, quiet, chained))
    except KeyboardInterrupt:
        pass  # the table says what is left, the exit code too
    finally:
        folder.mkdir(parents=True, exist_ok=True)
        summary.write(table_path)
        say(summary.text(), err=False)
        for names, path in pictures:
            _draw(summary, names, path, log or "", (size, dpi, title))
    summary.check()


def _say_what_is_anew(left, summary):
    """Name what has changed since runs that are done again, and say what others are doing."""
    from collections import Counter

    from rodsim.sweep.standing import changed_inputs

    changed = Counter(file for run in left for file in changed_inputs(run))
    for file, count in changed.items():
        warn(f"{file} has changed: {count} of the runs that began with it are run again")
    running = sum(summary.rows[run.name]["status"] == "running" for run in left)
    if running:
        click.echo(f"{running} of the runs are being done by other processes", err=True)


def _run(left, summary, table_path, options):
    """Start the engine and do what is left."""
    jobs, threads, scheduler, isolate, quiet, chained = options
    from rodsim.sweep.display import make_display

    if not scheduler:
        _compile(left[0], quiet)
    with _signals() as heard, make_display(summary, quiet) as display:

        def ended(run, failure):
            display.ended(summary.update(run, failure))
            summary.write_now_and_then(table_path)

        def asked():
            return bool(heard)

        if chained:
            from rodsim.sweep.rests import follow

            follow(left, threads, isolate, ended, asked, display)
            return
        from rodsim.sweep.schedule import Sweep

        with _engine(len(left), jobs, threads, scheduler, isolate) as engine:
            Sweep(engine, ended, summary.update, asked).finish(left, display)


def _engine(runs, jobs, threads, scheduler, isolate):
    """Return the engine that does the runs: this machine, or the workers of a scheduler."""
    if scheduler:
        from rodsim.sweep.cluster import connect

        return connect(scheduler, threads, isolate)
    from rodsim.sweep.local import Local, share

    return Local(*share(runs, jobs, threads), isolate)


def _chained(rest, saddle, origin, scheduler):
    """Tell whether each run starts from the one before; UsageError for options that do not fit."""
    from rodsim.errors import UsageError

    if not rest and (saddle or origin):
        option = "--saddle is for sweeps with --rest"
        raise UsageError(option if saddle else "--from is for sweeps with --rest; runs begin in a "
                         "state by `initial` of the case")
    if origin == "previous" and scheduler:
        raise UsageError("--from previous goes one by one, here: leave out --scheduler")
    return origin == "previous"


def _compile(run, quiet):
    """Compile what a run needs, and say so; what others need more, the first of them compiles."""
    prepare_numba()
    from rodsim.case import case_from_mapping
    from rodsim.errors import RodsimError
    from rodsim.run.warmup import ensure_compiled
    from rodsim.scene.build import build_scene

    with suppress(RodsimError):  # which that run will report
        scene = build_scene(case_from_mapping(run.data))
        ensure_compiled(scene, lambda line: quiet or say(line))


@contextmanager
def _signals():
    """Yield a list of the signals heard: whatever ends a job from outside stops it as Ctrl-C does.

    The second one does not wait: KeyboardInterrupt.
    """
    heard = []

    def interrupt(number, _):
        heard.append(number)
        if len(heard) > 1:
            raise KeyboardInterrupt

    numbers = [signal.SIGINT, signal.SIGTERM]
    hangup = getattr(signal, "SIGHUP", None)  # not everywhere; nohup has it ignored
    if hangup and signal.getsignal(hangup) != signal.SIG_IGN:
        numbers.append(hangup)
    before = {number: signal.signal(number, interrupt) for number in numbers}
    try:
        yield heard
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _draw(summary, names, path, log, sheet):
    """Draw one column over another, or a third one over two."""
    from rodsim.plotting.columns import plot_columns, plot_map
    from rodsim.plotting.style import Sheet
    from rodsim.sweep.series import axis_label, grid, series

    rows = [row for row in summary.rows.values() if {*names} <= row.keys()]
    if not rows:
        warn(f"{path}: not drawn: no run has {names[-1]} yet")
        return
    sheet, heads = Sheet(*sheet), [axis_label(summary, name) for name in names]
    if len(names) == 3:
        quantity = names[2].replace("_", " "), summary.unit(names[2])
        plot_map(path, *grid(summary, *names), heads, quantity, log, sheet)
    elif summary.at_rest:
        from rodsim.plotting.diagram import plot_diagram

        known = [row for row in rows if "growing_modes" in row]
        columns = ([row[c] for row in known] for c in (*names, "growing_modes"))
        plot_diagram(path, *columns, heads, sheet)
    else:
        plot_columns(path, *series(summary, *names), heads, log, sheet)
    click.echo(f"drew {path}", err=True)
