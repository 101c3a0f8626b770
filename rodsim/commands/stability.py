"""``rodsim stability``."""

import click

from rodsim.commands.common import from_option, say, set_option, written_path
from rodsim.commands.rest import (
    _FILE,
    at_option,
    begin,
    frame_option,
    overwrite_option,
    quiet_option,
    source_argument,
)


@click.command()
@source_argument
@click.option("-o", "--output", type=_FILE, default="modes.h5", show_default=True,
              help="Output: the state, then the state moved along each mode.")  # fmt: skip
@click.option("--modes", "count", type=click.IntRange(1, 200), default=6, show_default=True,
              help="How many modes that are not neutral, the growing ones first.")  # fmt: skip
@click.option("--rates", is_flag=True, help="Growth and decay in the fluid, to 400 points.")
@click.option("--csv", "csv_path", type=_FILE, help="Write the table to a file as well.")
@set_option
@from_option
@frame_option
@at_option
@overwrite_option
@quiet_option
def stability(
    source, output, count, rates, csv_path, overrides, origin, frame, time, overwrite, quiet
):
    """Tell whether a state at rest is stable: how many modes grow, and how fast.

    Of a case, or of a frame of an output such as one of rodsim rest; refused where that is not at
    rest.
    """
    if csv_path:
        written_path(csv_path, (".csv",))
    start = begin(source, overrides, origin, frame, time, quiet)
    from rodsim.rest.stability import stability_of, write_modes
    from rodsim.rest.tables import mode_table

    found = stability_of(start, count, rates)
    table = mode_table(found)
    say(table.text(), err=False)
    if csv_path:
        table.write_csv(csv_path)
    if found.modes is None or not len(found.modes.values):
        return
    moved = write_modes(found, output, overwrite)
    if not quiet:
        if moved:
            say(f"the earlier {output} is now {moved}")
        say(f"wrote {output}")
