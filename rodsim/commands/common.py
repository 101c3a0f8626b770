"""What several commands share: arguments, options, loading a case."""

from pathlib import Path

import click

from rodsim.text import printable

STILLS = (".png", ".pdf", ".svg")  # pictures
set_option = click.option(
    "--set",
    "overrides",
    multiple=True,
    metavar="KEY=VALUE",
    help="Change the case, e.g. --set rods.ring.shape.points=100 (again for more keys).",
)
from_option = click.option(
    "--from",
    "origin",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="OUT.h5",
    help="Start in the last state in an output: places of rods and bodies; time starts at 0.",
)
case_argument = click.argument("case_path", metavar="CASE.yaml", type=click.Path(path_type=Path))
output_argument = click.argument("output", metavar="OUT.h5", type=click.Path(path_type=Path))
threads_option = click.option(
    "--threads",
    type=click.IntRange(1, 1024),
    help="Number of threads; by default as many as the scene is worth.",
)
device_option = click.option(
    "--device",
    type=click.Choice(["cpu", "gpu"]),
    help="Where the sums are computed: cpu, or on a GPU, exactly (docs/large.md).",
)


def _seconds(ctx, param, text):
    from rodsim.run.stopping import parse_duration

    try:
        return None if text is None else parse_duration(text)
    except ValueError as error:
        raise click.BadParameter(str(error)) from None


max_wall_option = click.option(
    "--max-wall",
    callback=_seconds,
    metavar="TIME",
    help="Stop in time before so much wall time has gone, e.g. 3h50m; rodsim resume goes on.",
)


until_option = click.option(
    "--until",
    type=click.Choice(["still"]),
    help="End before time.end when nothing moves any more.",
)


def load(path, overrides):
    """Return the validated case in a file."""
    from rodsim.case import load_case

    return load_case(path, overrides)


def load_from(path, overrides, origin, frame=-1):
    """Return the validated case in a file, to begin in a frame of an output, if one is named."""
    from rodsim.case.starts import start_in

    return load(path, overrides if origin is None else [*overrides, start_in(origin, frame)])


def say(text, err=True) -> None:
    """Print text that can have come from a file; results with ``err=False``."""
    click.echo(printable(str(text)), err=err)


def warn(text) -> None:
    """Say what looks wrong but does not stop the command."""
    say(f"warning: {text}")


def say_warnings(case, scene=None) -> None:
    """Say what looks wrong in a case, and in its scene."""
    for problem in (*case.warnings, *(scene.warnings if scene else ())):
        warn(problem)


def is_output(path) -> bool:
    """Tell an output from a case, also one that is missing or is not what its name says."""
    from rodsim.files import has_hdf5_signature

    try:
        return path.suffix in (".h5", ".hdf5") or has_hdf5_signature(path)
    except OSError:
        return False


def placed(case, device):
    """Return a case whose sums are computed on a device; after ``prepare_numba``."""
    from rodsim.scene.device import on_device

    return on_device(case, device)


def prepare_numba() -> None:
    """Choose cache and threads; before anything imports Numba."""
    from rodsim.compiled.settings import prepare

    prepare()


def written_path(path, suffixes):
    """Return the path of a file to write; raises UsageError where its suffix is none of these."""
    from rodsim.errors import UsageError

    if path.suffix not in suffixes:
        raise UsageError(f"{path}: must end in one of {' '.join(suffixes)}")
    return path


def say_written(path, replaced, quiet=False) -> None:
    """Say which file a command has written, and whether another one was there."""
    if not quiet:
        say(f"wrote {path}{', in place of an earlier one' if replaced else ''}")
