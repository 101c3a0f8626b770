"""``rodsim converge``."""

from pathlib import Path

import click

from rodsim.commands.common import (
    case_argument,
    device_option,
    load,
    placed,
    prepare_numba,
    say,
    say_warnings,
    set_option,
    threads_option,
    warn,
)
from rodsim.commands.sheet import sheet_options


class _Axes(click.ParamType):
    """A list such as ``step,tolerance``."""

    name = "axes"

    def convert(self, value, param, ctx):
        from rodsim.convergence.rows import AXES

        names = [name.strip() for name in value.split(",")]
        for name in names:
            if name not in AXES:
                self.fail(f"'{name}' is none of {', '.join(AXES)}", param, ctx)
        return names


@click.command()
@case_argument
@click.option(
    "--in",
    "axes",
    type=_Axes(),
    default="tolerance,step,points,epsilon",
    show_default=True,
    metavar="AXES",
    help="What to vary.",
)
@click.option(
    "-o",
    "--output",
    "report",
    type=click.Path(path_type=Path),
    default="converge",
    show_default=True,
    help="Name of the report: .csv and .png are added; earlier ones are renamed.",
)
@set_option
@threads_option
@click.option(
    "--whole",
    is_flag=True,
    help="Run all rows of a fixed step to the end, not the costly ones over a first part only.",
)
@sheet_options
@device_option
@click.option("-q", "--quiet", is_flag=True, help="No progress.")
def converge(case_path, axes, report, overrides, threads, device, whole, size, dpi, title, quiet):
    """Measure error against run time of this very scene.

    Runs the case again and again: at other tolerances (rkc) and steps (euler, rk4), with other
    numbers of points (length and epsilon fixed), with other epsilons (a sensitivity) and, where it
    is asked for, with fast sums of other accuracies and with other numbers of points of bodies,
    each held against a reference that it computes itself. Ctrl-C keeps what has been measured.

    Methods of fixed step that need many times the evaluations of all else are run over the first
    twentieth only, but for the cheapest; the table marks them.
    """
    case = load(case_path, overrides)
    say_warnings(case)
    prepare_numba()
    case = placed(case, device)
    from rodsim.run.warmup import ensure_compiled
    from rodsim.scene.build import build_scene

    plain = build_scene(case)
    ensure_compiled(plain, lambda line: quiet or say(line))
    from rodsim.convergence import report as reporting
    from rodsim.convergence.study import Study
    from rodsim.output.paths import set_aside
    from rodsim.plotting.style import Sheet
    from rodsim.progress import make_progress

    name = report.name.removesuffix(".csv").removesuffix(".png")
    table, picture = (report.with_name(name + end) for end in (".csv", ".png"))
    for path in (table, picture):
        moved = set_aside(path)
        if moved:
            warn(f"the earlier {path} is now {moved}")
    rows, interrupted = reporting.CsvRows(table), False
    with make_progress(case.title or case_path.name, quiet) as progress:
        study = Study(
            lambda more: placed(load(case_path, (*overrides, *more)), device),
            axes,
            threads,
            progress,
            whole,
        )
        try:
            for section, result in study.run():
                rows.add(section, result)
        except KeyboardInterrupt:
            interrupted = True
    _show(study, table, picture, Sheet(size, dpi, title))
    if interrupted:
        raise KeyboardInterrupt


def _show(study, table, picture, sheet):
    from rodsim.convergence import report as reporting
    from rodsim.errors import UsageError
    from rodsim.plotting.convergence import plot_study

    say(reporting.text(study), err=False)
    written = [str(table)]
    try:
        plot_study(study, picture, sheet)
        written.append(str(picture))
    except UsageError as error:
        warn(error)
    say(f"wrote {' and '.join(written)}")
