"""Every figure and table of Olson, Lim & Cortez (2013), with the paper's claims beside ours."""

import sys
from pathlib import Path

import click
from figures.report import markdown
from figures.runs import Workplace

from rodsim.compiled.settings import prepare

FIGURES = ("fig2", "fig3", "fig4", "late", "fig5", "table3", "fig6")


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("names", nargs=-1, metavar="[FIGURE]...")
@click.option("--quick", is_flag=True, help="Minutes: fewer parameters, shorter runs.")
@click.option(
    "-o",
    "--output",
    "folder",
    default="paper",
    show_default=True,
    metavar="FOLDER",
    type=click.Path(path_type=Path, file_okay=False),
    help="Pictures, data, runs.",
)
@click.option(
    "--gib-minutes",
    type=float,
    metavar="T",
    help="Longest time for a run by the gIB method; default 90, quick 1.",
)
def main(names, quick, folder, gib_minutes):
    """Reproduce FIGUREs (fig2 fig3 fig4 late fig5 table3 fig6; default: all).

    For each a picture, the data as CSV, and rows of a table "paper says / we get / agrees", which
    is printed and written to table.md. A run whose output is in FOLDER/runs is not repeated.
    """
    unknown = [name for name in names if name not in FIGURES]
    if unknown:
        raise click.UsageError(f"no such figure: {', '.join(unknown)} (have {', '.join(FIGURES)})")
    prepare()
    folder.mkdir(parents=True, exist_ok=True)
    minutes = gib_minutes or (1.0 if quick else 90.0)
    rows = reproduce(names or FIGURES, Workplace(folder, quick, 60.0 * minutes))
    (folder / "table.md").write_text(markdown(rows) + "\n")
    click.echo(markdown(rows))


def reproduce(names, place):
    """Return the rows of some figures; pictures and data go to ``place``."""
    from figures import late_ring, open_rod, ring, swimming, table_3

    makers = {
        "fig2": open_rod.figure_2,
        "fig3": open_rod.figure_3,
        "fig4": ring.figure_4,
        "late": late_ring.late_ring,
        "fig5": ring.figure_5,
        "table3": table_3.table_3,
        "fig6": swimming.figure_6,
    }
    rows = []
    for name in names:
        click.echo(name, file=sys.stderr)
        rows += makers[name](place)
    return rows


if __name__ == "__main__":
    main()
