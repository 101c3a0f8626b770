"""``rodsim run``."""

from pathlib import Path

import click

from rodsim.commands.common import (
    case_argument,
    device_option,
    from_option,
    load_from,
    max_wall_option,
    placed,
    prepare_numba,
    say,
    say_warnings,
    set_option,
    threads_option,
    until_option,
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
@from_option
@threads_option
@device_option
@max_wall_option
@until_option
@click.option("--overwrite", is_flag=True, help="Replace an existing output file.")
@click.option("--force", is_flag=True, help="Run also with a fixed step above its limit.")
@click.option(
    "--dry-run", is_flag=True, help="Check the case and say what it would do and cost, no more."
)
@click.option("-q", "--quiet", is_flag=True, help="No progress and no summary.")
def run(
    case_path,
    output,
    overrides,
    origin,
    threads,
    device,
    max_wall,
    until,
    overwrite,
    force,
    dry_run,
    quiet,
):
    """Run a case and write its trajectory, energies and balances to an HDF5 file."""
    case = load_from(case_path, overrides, origin)
    say_warnings(case)
    prepare_numba()
    case = placed(case, device)
    if dry_run:
        from rodsim.commands import reports

        say(reports.describe_case(case, not force, threads), err=False)
        return
    from rodsim.commands.console import Console
    from rodsim.run.simulate import simulate

    with Console(output, quiet, max_wall).about(case, case_path.name) as console:
        simulate(
            case, output, overwrite=overwrite, threads=threads, force=force, until=until,
            listener=console,
        )  # fmt: skip
