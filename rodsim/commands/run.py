"""``rodsim run``."""

from pathlib import Path

import click

from rodsim.commands.common import (
    announce,
    case_argument,
    load,
    max_wall_option,
    prepare_numba,
    say,
    say_warnings,
    set_option,
    threads_option,
    warn,
)
from rodsim.files import DEFAULT_OUTPUT


@click.command()
@case_argument
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path, dir_okay=False),
    default=DEFAULT_OUTPUT,
    show_default=True,
    help="Output file; one that exists is renamed to out.1.h5, ...",
)
@set_option
@threads_option
@max_wall_option
@click.option("--overwrite", is_flag=True, help="Replace an existing output file.")
@click.option("--force", is_flag=True, help="Run also with a fixed step above its limit.")
@click.option("--dry-run", is_flag=True, help="Check the case and say what it would do, no more.")
@click.option("-q", "--quiet", is_flag=True, help="No progress and no summary.")
def run(case_path, output, overrides, threads, max_wall, overwrite, force, dry_run, quiet):
    """Run a case and write its trajectory, energies and balances to an HDF5 file."""
    from rodsim.commands import reports
    from rodsim.run.stopping import Stopper

    stop = Stopper(max_wall)
    case = load(case_path, overrides)
    say_warnings(case)
    prepare_numba()
    if dry_run:
        say(reports.describe_case(case, refuse=not force), err=False)
        return
    from rodsim.progress import make_progress
    from rodsim.run.warmup import ensure_compiled

    compiled = ensure_compiled(case, lambda line: quiet or say(line))
    from rodsim.run.simulate import Summary, simulate

    def inform(limits):
        if not quiet:
            say("\n".join(reports.describe_limits(limits, case.units.time)))

    summary = Summary(compile_seconds=compiled)
    label = case.title or case_path.name
    with announce(summary, output, quiet), stop, make_progress(label, quiet) as progress:
        simulate(
            case,
            output,
            overwrite=overwrite,
            threads=threads,
            force=force,
            stop=stop,
            notify=warn,
            inform=inform,
            progress=progress,
            summary=summary,
        )
