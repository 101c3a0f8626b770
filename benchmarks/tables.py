"""Medians with their spread, tables of them on the terminal and in CSV files."""

import csv
from dataclasses import dataclass

import click
import numpy as np


@dataclass(frozen=True)
class Spread:
    """Median and quartiles of repeated measurements."""

    median: float
    low: float
    high: float

    @classmethod
    def of(cls, samples, scale=1.0):
        low, median, high = scale * np.quantile(np.asarray(samples, float), [0.25, 0.5, 0.75])
        return cls(float(median), float(low), float(high))

    @property
    def error(self):
        """Distances of the quartiles from the median, as matplotlib's error bars want them."""
        return self.median - self.low, self.high - self.median


@dataclass
class Table:
    """Rows by column key; ``columns`` gives each key its heading with the unit."""

    name: str
    columns: dict[str, str]
    rows: list[dict]

    def cells(self):
        return [[_cell(row.get(key)) for key in self.columns] for row in self.rows]


def _digits(value):
    if isinstance(value, str):
        return value
    if isinstance(value, int) or 1000 <= abs(value) < 1e9:
        return f"{value:.0f}"
    return f"{value:.3g}"


def _cell(value):
    if value is None:
        return ""
    if isinstance(value, Spread):
        return f"{_digits(value.median)} ({_digits(value.low)}-{_digits(value.high)})"
    return _digits(value)


def show(tables, machine, repeats, markdown):
    """Print the machine and the tables."""
    facts = "; ".join(f"{name} {value}" for name, value in machine.items())
    click.echo(f"{facts}. Medians (quartiles) of {repeats} repeats, unless a table says otherwise.")
    for table in tables:
        cells = [list(table.columns.values()), *table.cells()]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        if markdown:
            cells.insert(1, ["-" * width for width in widths])
        left, between, right = ("| ", " | ", " |") if markdown else ("", "   ", "")
        click.echo(f"\n**{table.name}**\n" if markdown else f"\n{table.name}")
        for row in cells:
            padded = between.join(
                text.ljust(width) for text, width in zip(row, widths, strict=True)
            )
            click.echo(f"{left}{padded}{right}".rstrip())


def write_csv(path, tables, machine):
    """Write all tables to one file; a spread becomes three columns. ``#`` lines: the machine."""
    rows = [{"table": table.name, **_flat(row)} for table in tables for row in table.rows]
    names = list(dict.fromkeys(name for row in rows for name in row))
    with path.open("w", newline="") as stream:
        stream.writelines(f"# {name}: {value}\n" for name, value in machine.items())
        writer = csv.DictWriter(stream, names)
        writer.writeheader()
        writer.writerows(rows)


def _flat(row):
    flat = {}
    for key, value in row.items():
        if isinstance(value, Spread):
            flat |= {key: value.median, f"{key}_low": value.low, f"{key}_high": value.high}
        else:
            flat[key] = value
    return flat
