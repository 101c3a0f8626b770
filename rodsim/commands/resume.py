"""``rodsim resume``."""

import click

from rodsim.commands.common import (
    announce,
    max_wall_option,
    output_argument,
    prepare_numba,
    say,
    set_option,
    threads_option,
    warn,
)


@click.command()
@output_argument
@set_option
@threads_option
@max_wall_option
@click.option("-q", "--quiet", is_flag=True, help="No progress and no summary.")
def resume(output, overrides, threads, max_wall, quiet):
    """Go on where a run stopped or was killed, in the same file and with the same bits.

    --set can only give a later time.end, or more output.fields.
    """
    from rodsim.run.stopping import Stopper

    stop = Stopper(max_wall)
    prepare_numba()
    from rodsim.progress import make_progress
    from rodsim.run.past import open_past
    from rodsim.run.warmup import ensure_compiled

    with open_past(output, overrides) as past:
        case, complete = past.case, past.complete
    if complete:
        quiet or say(f"{output}: is finished; a later end: --set time.end=...")
        return
    compiled = ensure_compiled(case, lambda line: quiet or say(line))
    from rodsim.run.simulate import Summary, resume

    summary = Summary(compile_seconds=compiled)
    label = case.title or output.name
    with announce(summary, output, quiet), stop, make_progress(label, quiet) as progress:
        resume(
            output,
            overrides=overrides,
            threads=threads,
            stop=stop,
            notify=warn,
            progress=progress,
            summary=summary,
        )
