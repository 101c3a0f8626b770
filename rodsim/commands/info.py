"""``rodsim info``."""

from pathlib import Path

import click

from rodsim.commands.common import is_output, load, prepare_numba, say, say_warnings, set_option


@click.command()
@click.argument("path", metavar="CASE.yaml|OUT.h5", type=click.Path(path_type=Path))
@set_option
@click.option("--check", is_flag=True, help="Read the whole output and say if all of it is good.")
def info(path, overrides, check):
    """Describe a case (points, fastest rate, stable steps, what a run costs) or an output file."""
    if is_output(path):
        from rodsim.commands import stored_run

        say(stored_run.describe_output(path), err=False)
        if check:
            say(stored_run.check_output(path), err=False)
        return
    from rodsim.commands import reports

    case = load(path, overrides)
    say_warnings(case)
    prepare_numba()
    say(reports.describe_case(case), err=False)
