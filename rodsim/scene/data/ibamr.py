"""IBAMR's structures: .vertex, with .director, .rod, .spring beside it -> the points of one rod."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rodsim.errors import FileError
from rodsim.scene.data.text import TextTable, lines_of

LINKS = (".rod", ".spring")  # rows of segments that begin with the numbers of both points, from 0


def read_ibamr(path, triads: bool, rod: str | None):
    """Return positions (M, 3), triads (M, 3, 3) or None, and line numbers; raises FileError.

    A .vertex does not say where a rod ends and the next begins; a .rod or .spring beside it does.
    ``rod``: the number of the rod, from 1 on, in the order of their points.
    """
    position, lines = _counted(path.with_suffix(".vertex"), 1)
    director = None
    if triads:
        director = _counted(path.with_suffix(".director"), 3)[0].reshape(-1, 3, 3)
        if len(director) != len(position):
            count = len(director)
            raise FileError(f"{path}: {len(position)} points have {count} triads beside them")
    chosen = _choose(path, _rods(path, len(position)), rod)
    return position[chosen], director if director is None else director[chosen], lines[chosen]


def _choose(path, rods, rod):
    """Return the points, a slice, of the rod that is meant."""
    if rod is None and len(rods) == 1:
        return slice(*rods[0])
    if rod is not None and rod.isdecimal() and 1 <= int(rod) <= len(rods):
        return slice(*rods[int(rod) - 1])
    if len(rods) == 1:
        beside = " or ".join(f"{path.stem}{suffix}" for suffix in LINKS)
        raise FileError(
            f"{path}: is one curve, so there is no rod '{rod}': where one ends and the next "
            f"begins is known only from {beside} beside it"
        )
    some = ", ".join(f"{k}: points {a} to {b - 1}" for k, (a, b) in enumerate(rods[:4], start=1))
    more = ", ..." if len(rods) > 4 else ""
    raise FileError(f"{path}: has {len(rods)} rods: choose one by its number, rod: ({some}{more})")


def _rods(path, points):
    """Return (first, end) of the points of each rod, from the segments beside it."""
    beside = next((path.with_suffix(s) for s in LINKS if path.with_suffix(s).is_file()), None)
    if beside is None:
        return [(0, points)]
    ends = _ends(beside, points)
    starts = np.ones(
        points + 1, dtype=bool
    )  # a rod begins where no segment joins to the one before
    low, high = ends.min(axis=1), ends.max(axis=1)
    starts[high[high - low == 1]] = False
    rods = np.flatnonzero(starts)
    of = np.searchsorted(rods, ends, side="right")
    far = of[:, 0] != of[:, 1]
    if far.any():
        k = int(np.argmax(far))
        raise FileError(
            f"{beside}: joins points {ends[k, 0]} and {ends[k, 1]} of two rods: points of a rod "
            "follow each other"
        )
    return list(zip(rods[:-1].tolist(), rods[1:].tolist(), strict=True))


def _ends(path, points):
    """Return the numbers of both points of each segment, (n, 2)."""
    rows, numbers = _content(path)
    found = [row.split()[:2] for row in rows[1:]]
    for number, row in zip(numbers[1:], found, strict=True):
        if len(row) < 2 or not all(cell.isdecimal() and int(cell) < points for cell in row):
            raise FileError(
                f"{path}:{number}: a segment begins with two numbers from 0 to {points - 1}"
            )
    return np.array(found, dtype=int).reshape(-1, 2)


def _content(path):
    """Return the rows that are not empty, without comments, and their lines."""
    rows = [(k, row.split("#")[0].strip()) for k, row in enumerate(lines_of(path), 1)]
    return [row for _, row in rows if row], [k for k, row in rows if row]


def _counted(path: Path, rows_each: int):
    """Return numbers (count * rows_each, 3) and their lines."""
    if not path.is_file():
        raise FileError(f"{path}: no such file: a .vertex file needs its .director beside it")
    content, numbers = _content(path)
    count = content[0].split()[0] if content else ""
    if not count.isdecimal():
        raise FileError(f"{path}: begins with no count")
    needed = int(count) * rows_each
    if len(content) != needed + 1:
        raise FileError(f"{path}: says {count}, so needs {needed} rows; has {len(content) - 1}")
    table = TextTable(path, content[1:], numbers[1:], width=3)
    for k, row in enumerate(table.rows):
        if len(row.split()) != 3:
            raise table.fault(k, f"has {len(row.split())} numbers, needs 3")
    return table.floats([0, 1, 2]), table.numbers
