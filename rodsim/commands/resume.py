"""``rodsim resume``."""

from time import perf_counter

import click

from rodsim.commands.common import (
    device_option,
    max_wall_option,
    output_argument,
    prepare_numba,
    say,
    set_option,
    threads_option,
    until_option,
)


@click.command()
@output_argument
@set_option
@threads_option
@device_option
@max_wall_option
@until_option
@click.option("-q", "--quiet", is_flag=True, help="No progress and no summary.")
def resume(output, overrides, threads, device, max_wall, until, quiet):
    """Go on where a run stopped or was killed, in the same file and with the same bits.

    --set can only give a later time.end, or more output.fields. It goes on on the device that the
    file names, unless --device says otherwise.
    """
    prepare_numba()
    from rodsim.commands.console import Console
    from rodsim.run.past import open_past
    from rodsim.run.simulate import go_on

    started = perf_counter()
    with open_past(output, overrides) as past:
        if past.complete:
            quiet or say(f"{output}: is finished; a later end: --set time.end=...")
            return
        with Console(output, quiet, max_wall).about(past.case, output.name) as console:
            go_on(past, started, threads, console, until, device)
