"""A file of points, of any format that is known -> positions, triads, and what it says of both."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from rodsim.case.words import did_you_mean, one_of
from rodsim.errors import FileError
from rodsim.scene.data.columns import find, has, position_columns, triad_columns, unit_of
from rodsim.scene.data.ibamr import read_ibamr
from rodsim.scene.data.text import TextTable, lines_of, read_table, split

MOST_BYTES = 2**33  # of an array in an .npz, unpacked


@dataclass
class Points:
    """Points of one curve as a file has them, (M, 3), and their triads (M, 3, 3) or None.

    ``spacing``, ``closed``, ``unit`` (of length): None where the file does not say. ``breaks``:
    points before which there is a blank line; ``lines``: of the points in the file, or None.
    """

    path: Path
    position: np.ndarray
    director: np.ndarray | None = None
    spacing: float | None = None
    closed: bool | None = None
    unit: str | None = None
    breaks: list[int] = field(default_factory=list)
    lines: list[int] | None = None

    def name(self, k: int) -> str:
        """Return how a point is called in messages: by its line, else by its number."""
        k = int(k) % len(self.position)
        return f"point {k}" if self.lines is None else f"point {k} (line {self.lines[k]})"


def read_points(path, triads, columns=None, frame=None, rod=None) -> Points:
    """Return the points in a file; raises FileError.

    ``triads``: whether they are needed. ``columns``: of a text table. ``frame``: number of the
    frame, where there are several, by default the last; ``rod``: name of the rod, likewise, or its
    number from 1 on where rods have none.
    """
    suffix, rod = path.suffix.lower(), None if rod is None else str(rod)
    if suffix == ".npz":
        return _from_npz(path, triads, frame, rod)
    if suffix in (".vertex", ".director"):
        if frame is not None:
            raise FileError(f"{path}: has no frames to choose one from")
        position, director, lines = read_ibamr(path, triads, rod)
        return Points(path, position, director, lines=lines)
    if suffix == ".xyz":
        table, frame = _xyz(path, frame), None
    else:
        table = read_table(path)
    table, spacing = _one_rod(table, frame, rod)
    chosen = triad_columns(table, columns) if triads else position_columns(table, columns)
    values, unit = table.floats(chosen), unit_of(table, chosen[:3])
    position = np.zeros((len(values), 3))
    width = min(3, len(chosen))
    position[:, :width] = values[:, :width]
    director = values[:, 3:].reshape(-1, 3, 3) if triads else None
    return Points(path, position, director, spacing, None, unit, table.breaks, table.numbers)


def _one_rod(table, frame, rod):
    """Return the rows of one frame and one rod, and the spacing if the table is an own export."""
    if has(table, "frame"):
        values = table.floats([find(table, "frame")])[:, 0]
        known = np.unique(values)
        wanted = _pick(known, -1 if frame is None else frame, table.path)
        table = table.select(np.flatnonzero(values == wanted))
    elif frame is not None:
        raise FileError(f"{table.path}: has no column 'frame' to choose one from")
    if has(table, "rod"):
        values = table.texts(find(table, "rod"))
        table = table.select(np.flatnonzero(values == _which(values, rod, table.path)))
    elif rod is not None and table.breaks:
        table = _block(table, rod)
    elif rod is not None:
        raise FileError(f"{table.path}: has no column 'rod' to choose one from")
    own = all(has(table, name) for name in ("frame", "rod", "point", "s"))
    arc = table.floats([find(table, "s")])[:, 0] if own else ()
    return table, float(arc[1]) if len(arc) > 1 and arc[1] > 0.0 else None


def _block(table, rod):
    """Return the rows of one of the blocks that blank lines separate."""
    ends = [0, *table.breaks, len(table.rows)]
    if not (rod.isdecimal() and 1 <= int(rod) < len(ends)):
        raise FileError(f"{table.path}: has no block {rod}: rod is 1 to {len(ends) - 1}")
    return table.select(np.arange(*ends[int(rod) - 1 : int(rod) + 1])).whole()


def _pick(known, frame, path):
    """Return the frame of that number; a negative one counts from the end."""
    if frame < 0 and -frame <= len(known):
        return known[frame]
    if frame in known:
        return frame
    raise FileError(
        f"{path}: has no frame {frame}: {len(known)} from {known[0]:g} to {known[-1]:g}"
    )


def _which(names, rod, path):
    known = list(dict.fromkeys(str(name) for name in names))
    if rod is None and len(known) == 1:
        return known[0]
    if rod not in known:
        hint = did_you_mean(rod or "", known)
        raise FileError(f"{path}: 'rod' must be {one_of(known)}{hint}")
    return rod


def _xyz(path, frame):
    """Return the table of one frame of an .xyz file: count, comment, then a name and x y z."""
    lines, starts, at = lines_of(path), [], 0
    while at < len(lines) and lines[at].strip():
        if not lines[at].split()[0].isdecimal():
            raise FileError(f"{path}:{at + 1}: an .xyz file has the number of atoms here")
        starts.append(at)
        at += int(lines[at].split()[0]) + 2
    if not starts or at > len(lines):
        count = lines[starts[-1]].split()[0] if starts else "no"
        left = sum(bool(line.strip()) for line in lines[starts[-1] + 2 :]) if starts else 0
        raise FileError(f"{path}: says {count} atoms and has {left}")
    number = -1 if frame is None else frame
    if not -len(starts) <= number < len(starts):
        raise FileError(f"{path}: has no frame {number}: {len(starts)} from 0 on")
    begin = starts[number] + 2
    rows = lines[begin : begin + int(lines[begin - 2].split()[0])]
    table = TextTable(path, rows, list(range(begin + 1, begin + 1 + len(rows))))
    for k, row in enumerate(rows):
        if len(split(row, None)) < 4:
            raise table.fault(k, "an atom is a name and three numbers")
    more = max(len(split(row, None)) for row in rows) - 4 if rows else 0
    table.names, table.width = ("name", "x", "y", "z", *("-",) * more), 4 + more
    return table


def _from_npz(path, triads, frame, rod):
    """Read an export of rodsim: positions (T, N, 3), triads (T, N, 3, 3), the rods' tables."""
    import zipfile  # few cases have such a file

    try:
        with np.load(path, allow_pickle=False) as file:
            _check_sizes(path)
            names = file["rod_name"]
            r = int(np.flatnonzero(names == _which(names, rod, path))[0])
            first, count = int(file["rod_first"][r]), int(file["rod_count"][r])
            nodes = slice(first, first + count)
            frames = np.arange(len(file["time"]))
            at = int(_pick(frames, -1 if frame is None else frame, path))
            position = np.array(file["position"][at, nodes], dtype=float)
            director = np.array(file["director"][at, nodes], dtype=float) if triads else None
            spacing, closed = float(file["rod_spacing"][r]), bool(file["rod_closed"][r])
            unit = json.loads(str(file["units"]))["position"]
    except KeyError as error:
        raise FileError(f"{path}: not an export of rodsim: {error.args[0]}") from error
    except (OSError, ValueError, IndexError, TypeError, zipfile.BadZipFile) as error:
        raise FileError(f"{path}: cannot be read: {error}") from error
    if position.shape != (count, 3) or not np.isfinite(position).all():
        raise FileError(f"{path}: its positions are not whole")
    return Points(path, position, director, spacing, closed, unit)


def _check_sizes(path):
    import zipfile

    with zipfile.ZipFile(path) as file:
        for member in file.infolist():
            if member.file_size > MOST_BYTES:
                raise ValueError(f"{member.filename} would need {member.file_size / 1e9:.3g} GB")
