"""A CSV file of values: one run for each row, the first row names the keys."""

from __future__ import annotations

import csv
from io import StringIO
from pathlib import Path

from rodsim.case.yaml_text import parse
from rodsim.errors import CaseError, Problem, UsageError


def read_table(path) -> list[tuple[str, dict]]:
    """Return (file:line, values) of every row; an empty cell sets nothing.

    Raises CaseError for what cannot be read, for a row of another length, and for a key that two
    columns have.
    """
    (where, heads), *lines = _lines(path)
    keys = [key.strip() for key in heads]
    if twice := sorted({key for key in keys if key and keys.count(key) > 1}):
        reason = f"two columns have it: {', '.join(_places(keys, twice[0]))}; keep one"
        raise CaseError([Problem(where, twice[0], None, reason)])
    return [(where, _values(where, keys, cells)) for where, cells in lines]


def _lines(path):
    """Return (file:line, cells) of every row that is neither empty nor a comment."""
    # Only line ends end a line: Python's splitlines takes form feeds and others for one as well.
    lines = [
        (number, line)
        for number, line in enumerate(StringIO(_text(path), newline=None), 1)
        if line.strip() and not line.startswith("#")
    ]
    found, reader = [], csv.reader((line for _, line in lines), strict=True)
    try:
        begin = 0  # a quoted cell can go on over lines
        for cells in reader:
            found.append((f"{path}:{lines[begin][0]}", cells))
            begin = reader.line_num
    except csv.Error as error:
        where = f"{path}:{lines[min(begin, len(lines) - 1)][0]}"
        raise CaseError([Problem(where, "", None, f"is not CSV: {error}")]) from None
    if len(found) < 2:
        raise UsageError(f"{path}: needs a line of keys and at least one of values")
    return found


def _text(path):
    try:
        return Path(path).read_bytes().decode("utf-8-sig")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "not UTF-8 text"
        raise CaseError([Problem(str(path), "", None, f"cannot read: {reason}")]) from None


def _places(keys, key):
    return [f"column {number}" for number, other in enumerate(keys, 1) if other == key]


def _values(where, keys, cells):
    if len(cells) != len(keys):
        reason = f"has {len(cells)} cells where the first line has {len(keys)} keys"
        raise CaseError([Problem(where, "", None, reason)])
    given = {key: cell for key, cell in zip(keys, cells, strict=True) if cell.strip()}
    return {key: parse(cell, lambda line: where, (key,))[0] for key, cell in given.items()}
