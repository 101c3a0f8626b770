"""``rodsim rest``."""

from pathlib import Path

import click

from rodsim.commands.common import (
    from_option,
    is_output,
    load_from,
    prepare_numba,
    say,
    say_warnings,
    set_option,
    warn,
)

_FILE = click.Path(path_type=Path, dir_okay=False)
source_argument = click.argument("source", metavar="CASE.yaml|OUT.h5", type=_FILE)
frame_option = click.option("--frame", type=int, default=-1, show_default=True,
                            help="Which frame of the output.")  # fmt: skip
at_option = click.option("--at", "time", type=float, metavar="T",
                         help="Time at which driven numbers are taken.")  # fmt: skip
quiet_option = click.option("-q", "--quiet", is_flag=True, help="No progress.")
overwrite_option = click.option("--overwrite", is_flag=True, help="Replace an existing output.")


@click.command()
@source_argument
@click.option("-o", "--output", type=_FILE, default="rest.h5", show_default=True,
              help="Output: the start and the state at rest.")  # fmt: skip
@set_option
@from_option
@frame_option
@at_option
@click.option("--saddle", is_flag=True, help="Stay at a state that is not stable.")
@overwrite_option
@quiet_option
def rest(source, output, overrides, origin, frame, time, saddle, overwrite, quiet):
    """Find the shape at which a scene comes to rest: no load is left anywhere.

    From a case, or from a frame of an output. It goes down in energy as a rod with drag would, by
    ever longer steps, and leaves states that are not stable. Writes two frames, the start and the
    rest. Exit code 3 where it does not come to rest.
    """
    from rodsim.output.paths import check_place

    check_place(output, overwrite)  # before the wait for the compiler, and for the state
    start = begin(source, overrides, origin, frame, time, quiet)
    from rodsim.errors import DivergedError
    from rodsim.rest.find import find
    from rodsim.rest.report import describe

    report = find(start, output, saddle, overwrite, _progress(source.name, quiet), warn)
    say(describe(report), err=False)
    if not quiet:
        if report.moved:
            say(f"the earlier {output} is now {report.moved}")
        say(f"wrote {output}")
    if report.rest.failure:
        raise DivergedError(f"{output}: {report.rest.failure}")


def begin(source, overrides, origin, frame, time, quiet):
    """Return what a command starts from; says what looks wrong in it, and compiles."""
    from rodsim.errors import UsageError

    prepare_numba()
    from rodsim.rest.start import at_time, start_from_case, start_from_output

    require_scipy()
    if is_output(source):
        if origin is not None:
            raise UsageError("--from is for a case: an output has its own states, see --frame")
        start = start_from_output(source, overrides, frame)
    else:
        if origin is None and frame != -1:
            raise UsageError("--frame is of an output: give one, here or with --from")
        start = start_from_case(load_from(source, overrides, origin, frame))
    start = at_time(start, time)
    say_warnings(start.case, start.scene)
    _compile(start.scene, quiet)
    return start


def _compile(scene, quiet):
    """Compile what the scene needs in a process of its own, and say so."""
    from dataclasses import replace

    from rodsim.compiled.parts import PartList
    from rodsim.rest.forces import exact_parts
    from rodsim.run.warmup import ensure_compiled

    parts = PartList([*scene.parts, *exact_parts(scene)])
    ensure_compiled(replace(scene, parts=parts), lambda line: quiet or say(line))


def require_scipy():
    """Raise UsageError where the extra is not installed."""
    from importlib.util import find_spec

    from rodsim.errors import UsageError

    if find_spec("scipy") is None:
        raise UsageError("rest and stability need SciPy: pip install 'rodsim[rest]'")


def _progress(name, quiet):
    from rodsim.rest.report import Steps

    return Steps(name, quiet)
