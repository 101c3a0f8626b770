"""Text tables as people have them -> rows, names of columns, numbers.

Commas, semicolons, tabs or blanks between the cells; comments after # or %; headers; a byte order
mark; line ends of any system; Fortran's D exponents; decimal commas where the cells are not apart
by commas. Memory is of the file's size.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace

import numpy as np

from rodsim.errors import FileError

_LINE = re.compile(r"\r\n|\n|\r")
_COMMENT = re.compile(r"[#%].*")
_FORTRAN = re.compile(r"(?<=[\d.])[dD](?=[+-]?\d)")
_DECIMAL_COMMA = re.compile(r"(?<=\d),(?=\d)")
_MARKS = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16", b"\xef\xbb\xbf": "utf-8-sig"}
LONGEST_CELL = 30  # characters, in messages


@dataclass
class TextTable:
    """The rows of a table. ``names``: of its columns, or (); ``numbers``: of the rows' lines.

    ``delimiter``: what ``str.split`` takes; ``width``: cells of a row; ``breaks``: rows before
    which there was a blank line.
    """

    path: object
    rows: list[str]
    numbers: list[int]
    names: tuple[str, ...] = ()
    delimiter: str | None = None
    width: int = 0
    breaks: list[int] = field(default_factory=list)

    def cells(self, row: int) -> list[str]:
        """Return the cells of a row as texts."""
        return split(self.rows[row], self.delimiter)

    def texts(self, column: int) -> np.ndarray:
        """Return a column as texts, (n,)."""
        return np.array([split(row, self.delimiter)[column] for row in self.rows])

    def floats(self, columns: list[int]) -> np.ndarray:
        """Return some columns as finite numbers, (n, columns); raises FileError with the line."""
        if not self.rows:
            raise FileError(f"{self.path}: has no rows")
        rows = (_FORTRAN.sub("e", row) for row in self.rows)
        try:
            values = np.loadtxt(
                rows, delimiter=self.delimiter, usecols=columns, ndmin=2, comments=None
            )
        except ValueError:
            values = np.array([[np.nan]])
        if values.shape != (len(self.rows), len(columns)) or not np.isfinite(values).all():
            raise self._not_finite(columns)
        return values

    def select(self, keep: np.ndarray) -> TextTable:
        """Return the table of the rows numbered ``keep``."""
        rows, numbers = ([values[k] for k in keep] for values in (self.rows, self.numbers))
        breaks = np.flatnonzero(np.isin(keep, self.breaks)).tolist()
        return TextTable(self.path, rows, numbers, self.names, self.delimiter, self.width, breaks)

    def whole(self) -> TextTable:
        """Return the table without its breaks."""
        return replace(self, breaks=[])

    def label(self, column: int) -> str:
        """Return what a column is called in a message."""
        return self.names[column] if self.names else f"column {column + 1}"

    def fault(self, row: int, reason: str) -> FileError:
        """Return the error of a row."""
        return FileError(f"{self.path}:{self.numbers[row]}: {reason}")

    def _not_finite(self, columns):
        """Return the error of the first cell that is no finite number."""
        for row in range(len(self.rows)):
            cells = self.cells(row)
            for column in columns:
                value = number(cells[column])
                if value is None or not np.isfinite(value):
                    return self.fault(row, f"{self.label(column)} {_why(cells[column])}")
        return FileError(f"{self.path}: cannot be read as a table of numbers")


def read_table(path, corner=False) -> TextTable:
    """Return the table in a text file; raises FileError where there is none.

    ``corner``: the first cell of the first row may be missing or a text; it becomes 0.
    """
    table, heads = TextTable(path, [], []), []
    blank = False
    for line_number, line in enumerate(lines_of(path), start=1):
        content = _COMMENT.sub("", line).replace('"', "").strip(" ")
        if not content.strip():
            blank = blank or not line.strip()
            if line.strip() and not table.rows:
                heads = [line.lstrip("#% ").replace('"', "")]  # as numpy.savetxt writes them
        elif not table.rows and not _has_number(content):
            heads.append(content)
        else:
            if blank and table.rows:
                table.breaks.append(len(table.rows))
            table.rows.append(content)
            table.numbers.append(line_number)
            blank = False
    if not table.rows:
        raise FileError(f"{path}: has no numbers: not a table")
    _lay_out(table, heads)
    if corner:
        _fill_corner(table)
    _check_widths(table)
    return table


def lines_of(path) -> list[str]:
    """Return the lines of a text file in any of the usual encodings; raises FileError."""
    try:
        with open(path, "rb") as stream:
            data = stream.read()
    except OSError as error:
        raise FileError(f"{path}: cannot be read: {error.strerror or error}") from error
    encoding = next((name for mark, name in _MARKS.items() if data.startswith(mark)), "utf-8")
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError:
        text = data.decode("latin-1")  # numbers are the same in all of them
    if "\0" in text:
        raise FileError(f"{path}: not a text table")
    return _LINE.split(text.replace("\N{MINUS SIGN}", "-"))


def split(row: str, delimiter: str | None) -> list[str]:
    """Return the cells of a row without the blanks around them."""
    return [cell.strip() for cell in row.split(delimiter)]


def number(cell: str) -> float | None:
    """Return the number in a cell, or None."""
    try:
        return None if "_" in cell else float(_FORTRAN.sub("e", cell))
    except ValueError:
        return None


def _has_number(content):
    cells = re.split(r"[;,\s]+", content)
    return any(number(cell) is not None for cell in cells)


def _why(cell):
    if not cell:
        return "is missing"
    if number(cell) is not None:
        return f"is {cell}: must be finite"
    hint = ": write decimals with a point" if re.search(r"\d,\d|\d\s+\d", cell) else ""
    return f"is '{cell[:LONGEST_CELL]}', not a number{hint}"


def _lay_out(table, heads):
    """Find what is between the cells, the width, and the names of the columns."""
    delimiter = table.delimiter = _delimiter(table.rows[-1])
    if delimiter != ",":
        table.rows = [_DECIMAL_COMMA.sub(".", row) for row in table.rows]
    if delimiter and all(row.endswith(delimiter) for row in table.rows):
        table.rows = [row.removesuffix(delimiter) for row in table.rows]
        heads = [head.strip(" ").removesuffix(delimiter) for head in heads]
    table.width = len(table.rows[-1].split(delimiter))
    for head in heads:
        names = tuple(split(head, delimiter if delimiter and delimiter in head else None))
        if len(names) == table.width and not table.names:
            table.names = names


def _fill_corner(table):
    first, rest = table.cells(0), table.width - 1
    if number(first[0]) is None or len(first) == rest:
        cells = ["0", *(first if len(first) == rest else first[1:])]
        table.rows[0] = (table.delimiter or " ").join(cells)


def _check_widths(table):
    for row, text in enumerate(table.rows):
        width = len(text.split(table.delimiter))
        if width != table.width:
            others = f"the last row {table.width}"
            raise table.fault(row, f"has {width} cell{'s' * (width != 1)}, {others}")


def _delimiter(row):
    """Return what is between the cells of a row; None for blanks, also "0,5 1,5" with commas."""
    for sign in (";", "\t", ","):
        if sign in row:
            pairs = [cell.split() for cell in split(row, sign)]
            mixed = any(len(pair) > 1 and None not in map(number, pair) for pair in pairs)
            return None if mixed else sign
    return None
