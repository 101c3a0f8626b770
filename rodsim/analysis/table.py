"""Numbers over time with named, unit-bearing columns: as text, as CSV."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

WIDTH = 13  # of a number such as -1.234567e-12


@dataclass(frozen=True)
class Column:
    """What stands at the head of a column.

    name : of a quantity, with what it is of before it and its component behind, ``tail.speed``.
    quantity, of : the same two apart, for pictures.
    """

    name: str
    unit: str
    quantity: str
    of: str


@dataclass(frozen=True)
class Table:
    """Columns over time: ``time`` (T,), ``values`` (T, columns)."""

    columns: tuple[Column, ...]
    time: np.ndarray
    values: np.ndarray
    time_unit: str

    def text(self) -> str:
        """Return the table as aligned text, under two lines of names and units."""
        heads = [("time", self.time_unit), *((c.name, _shown(c.unit)) for c in self.columns)]
        return aligned(zip(*heads, strict=True), np.column_stack([self.time, self.values]))

    def write_csv(self, path) -> None:
        """Write the table with full precision; raises FileError."""
        from rodsim.export.tables import head, write_csv

        heads = [head("time", self.time_unit), *(head(c.name, c.unit) for c in self.columns)]
        write_csv(path, heads, [[self.time, *self.values.T]])


def aligned(heads, rows) -> str:
    """Return lines of heads, each a list of texts, and rows of numbers, as aligned text."""
    heads = [list(line) for line in heads]
    widths = [max(WIDTH, *map(len, column)) for column in zip(*heads, strict=True)]
    lines = [[*line] for line in heads]
    lines += [[f"{value:.6e}" for value in row] for row in rows]
    fit = ((text.rjust(width) for text, width in zip(line, widths, strict=True)) for line in lines)
    return "\n".join("  ".join(line) for line in fit)


def _shown(unit):
    return "" if unit == "1" else unit
