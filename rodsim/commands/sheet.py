"""What a picture is drawn on, as options: --size, --dpi, --title."""

import re

import click

INCHES = {"mm": 1 / 25.4, "cm": 1 / 2.54, "in": 1.0}
SMALLEST, LARGEST = 0.4, 80.0  # inches


class Size(click.ParamType):
    """Width and height as ``86x60``, in mm, or with a unit: ``8.6x6cm``, ``3.4x2.4in``."""

    name = "WIDTHxHEIGHT"

    def convert(self, value, param, ctx):
        """Return (width, height) in inches."""
        if isinstance(value, tuple):
            return value
        number = r"(\d+\.?\d*|\.\d+)"
        found = re.fullmatch(rf"{number}\s*[xX×]\s*{number}\s*(mm|cm|in)?", value.strip())
        if not found:
            self.fail(f"{value!r}: write width and height as 86x60 (mm), 8.6x6cm or 3.4x2.4in")
        width, height, unit = found.groups()
        size = tuple(float(side) * INCHES[unit or "mm"] for side in (width, height))
        if not all(SMALLEST <= side <= LARGEST for side in size):
            self.fail(f"{value!r}: sides must be from 10 mm to 2 m")
        return size


def sheet_options(command):
    """Add --size, --dpi and --title to a command, which gets them as ``size, dpi, title``."""
    for option in (
        click.option("--title", metavar="TEXT",
                     help="Heading in place of the case's title; '' for none."),
        click.option("--dpi", type=click.IntRange(20, 2400), metavar="N",
                     help="Points to the inch of a .png or a movie; by default 160, of a movie "
                     "200. Journals ask for 300 to 600."),
        click.option("--size", type=Size(), metavar="WIDTHxHEIGHT",
                     help="Of the whole picture: 86x60 (mm, a column of a journal), 8.6x6cm, "
                     "3.4x2.4in; by default what fits."),
    ):  # fmt: skip
        command = option(command)
    return command
