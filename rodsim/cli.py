"""The ``rodsim`` command: parse, call, print, exit code. Nothing heavy is imported up here.

Results go to stdout, everything else to stderr.
"""

from __future__ import annotations

import sys
from pathlib import Path

import click

import rodsim
from rodsim.errors import RodsimError

EXIT_CODES = """\b
Exit codes:
   0  done
   1  a bug in rodsim
   2  bad usage, or a case file missing, unreadable or invalid
   3  the run diverged
   4  an output or shape file missing, unreadable, locked or not ours, or a write failed
  75  stopped early on purpose
"""


class _Command(click.Command):
    """A command whose errors become text and an exit code, here and nowhere else."""

    def invoke(self, ctx):
        try:
            return super().invoke(ctx)
        except RodsimError as error:
            click.echo(str(error), err=True)
            ctx.exit(error.exit_code)
        except KeyboardInterrupt:
            click.echo("interrupted", err=True)
            ctx.exit(75)
        except BrokenPipeError:
            sys.stderr.close()  # whoever read our output has gone; nothing is left to say
            ctx.exit(0)


class _Group(click.Group):
    command_class = _Command


@click.group(
    cls=_Group, epilog=EXIT_CODES, context_settings={"help_option_names": ["-h", "--help"]}
)
@click.version_option(rodsim.__version__, package_name="rodsim")
def main():
    """Elastic rods that bend, twist, shear and stretch in a fluid at zero Reynolds number.

    Start with: rodsim new ring case.yaml, then rodsim run case.yaml
    """


set_option = click.option(
    "--set",
    "overrides",
    multiple=True,
    metavar="KEY=VALUE",
    help="Change the case, e.g. --set rods.ring.shape.points=100 (again for more keys).",
)
case_argument = click.argument("case_path", metavar="CASE.yaml", type=click.Path(path_type=Path))
output_argument = click.argument("output", metavar="OUT.h5", type=click.Path(path_type=Path))
threads_option = click.option(
    "--threads",
    type=click.IntRange(1, 1024),
    help="Number of threads; by default as many as the scene is worth.",
)


@main.command()
@case_argument
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path, dir_okay=False),
    default="out.h5",
    show_default=True,
    help="Output file; one that exists is renamed to out.1.h5, ...",
)
@set_option
@threads_option
@click.option("--overwrite", is_flag=True, help="Replace an existing output file.")
@click.option("--force", is_flag=True, help="Run also with a fixed step above its limit.")
@click.option("--dry-run", is_flag=True, help="Check the case and say what it would do, no more.")
@click.option("-q", "--quiet", is_flag=True, help="No progress and no summary.")
def run(case_path, output, overrides, threads, overwrite, force, dry_run, quiet):
    """Run a case and write its trajectory, energies and balances to an HDF5 file."""
    from rodsim import reports

    case = _load(case_path, overrides)
    _say_warnings(case)
    _prepare_numba()
    if dry_run:
        click.echo(reports.describe_case(case))
        return
    from rodsim.progress import make_progress
    from rodsim.warmup import ensure_compiled

    compiled = ensure_compiled(case, lambda line: quiet or click.echo(line, err=True))
    from rodsim.simulation import Summary, simulate

    summary = Summary(compile_seconds=compiled)
    try:
        with make_progress(case.title or case_path.name, quiet) as progress:
            simulate(
                case,
                output,
                overwrite=overwrite,
                threads=threads,
                force=force,
                notify=_warn,
                progress=progress,
                summary=summary,
            )
    finally:
        if not quiet and summary.runtime:
            click.echo(reports.run_summary(summary, output), err=True)


@main.command()
@click.argument("kind", type=click.Choice(["open", "ring", "flagellum"]))
@click.argument("file", required=False, type=click.Path(path_type=Path, dir_okay=False))
def new(kind, file):
    """Write a commented case to start from, to FILE or to the terminal."""
    from rodsim.case import template
    from rodsim.errors import FileError

    if file is None:
        click.echo(template(kind), nl=False)
        return
    try:
        with file.open("x") as stream:
            stream.write(template(kind))
    except FileExistsError:
        raise FileError(f"{file}: exists already, not overwritten") from None
    except OSError as error:
        raise FileError(f"{file}: cannot be written: {error.strerror}") from error
    click.echo(f"wrote {file}; run it with: rodsim run {file}", err=True)


@main.command()
@click.argument(
    "cases", metavar="CASE.yaml...", nargs=-1, required=True, type=click.Path(path_type=Path)
)
@set_option
@click.pass_context
def validate(ctx, cases, overrides):
    """Check case files and report every problem at once; run nothing."""
    code = 0
    for path in cases:
        try:
            case = _load(path, overrides)
            from rodsim.rods import build_scene

            build_scene(case)
        except RodsimError as error:
            click.echo(str(error), err=True)
            code = max(code, error.exit_code)
        else:
            _say_warnings(case)
            click.echo(f"{path}: valid")
    ctx.exit(code)


@main.command()
@click.argument("path", metavar="CASE.yaml|OUT.h5", type=click.Path(path_type=Path))
@set_option
def info(path, overrides):
    """Describe a case (points, fastest rate, stable steps) or an output file."""
    from rodsim import reports

    if _is_output(path):
        click.echo(reports.describe_output(path))
        return
    case = _load(path, overrides)
    _say_warnings(case)
    _prepare_numba()
    click.echo(reports.describe_case(case))


@main.command()
@output_argument
@click.option("--kT", "kelvin", type=click.FloatRange(0, min_open=True), metavar="KELVIN",
              help="Give energies in kT at this temperature, e.g. 298.")  # fmt: skip
@click.option("--csv", "csv_path", type=click.Path(path_type=Path, dir_okay=False),
              help="Write the table to a file as well.")  # fmt: skip
@click.option("--plot", "plot_path", type=click.Path(path_type=Path, dir_okay=False),
              help="Draw the energies over time (needs rodsim[plot]).")  # fmt: skip
def energy(output, kelvin, csv_path, plot_path):
    """Print bending, twisting, shear, stretch, total and kinetic energy over time."""
    from rodsim.analysis.energy import energy_table

    table = energy_table(output, kelvin)
    click.echo(table.text())
    if csv_path:
        table.write_csv(csv_path)
    if plot_path:
        from rodsim.plotting.energy import plot_energies

        plot_energies(table, plot_path)


@main.command()
def schema():
    """Print the JSON Schema of the case file, for editors."""
    import json

    from rodsim.case import case_schema

    click.echo(json.dumps(case_schema(), indent=2))


def _load(path, overrides):
    from rodsim.case import load_case

    return load_case(path, overrides)


def _say_warnings(case):
    for problem in case.warnings:
        _warn(problem)


def _warn(text):
    click.echo(f"warning: {text}", err=True)


def _is_output(path):
    """Tell an output from a case, also one that is missing or is not what its name says."""
    from rodsim.files import has_hdf5_signature

    try:
        return path.suffix in (".h5", ".hdf5") or has_hdf5_signature(path)
    except OSError:
        return False


def _prepare_numba():
    from rodsim.settings import prepare

    prepare()
