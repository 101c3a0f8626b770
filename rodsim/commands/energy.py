"""``rodsim energy``."""

from pathlib import Path

import click

from rodsim.commands.common import STILLS, output_argument, say, written_path
from rodsim.commands.sheet import sheet_options


@click.command()
@output_argument
@click.option("--kT", "kelvin", type=click.FloatRange(0, min_open=True), metavar="KELVIN",
              help="Give energies in kT at this temperature, e.g. 298.")  # fmt: skip
@click.option("--csv", "csv_path", type=click.Path(path_type=Path, dir_okay=False),
              help="Write the table to a file as well.")  # fmt: skip
@click.option("--plot", "plot_path", type=click.Path(path_type=Path, dir_okay=False),
              help="Draw the energies over time (needs rodsim[plot]).")  # fmt: skip
@sheet_options
def energy(output, kelvin, csv_path, plot_path, size, dpi, title):
    """Print bending, twisting, shear, stretch, total and kinetic energy over time.

    With tethers theirs too, part of the total; where anything acts from outside, its work and what
    the fluid has dissipated since t = 0.
    """
    from rodsim.analysis.energy import energy_table

    if csv_path:
        written_path(csv_path, (".csv",))
    if plot_path:
        written_path(plot_path, STILLS)
    table = energy_table(output, kelvin)
    say(table.text(), err=False)
    if csv_path:
        table.write_csv(csv_path)
    if plot_path:
        from rodsim.plotting.energy import plot_energies
        from rodsim.plotting.style import Sheet

        plot_energies(table, plot_path, Sheet(size, dpi, title))
