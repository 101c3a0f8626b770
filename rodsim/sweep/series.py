"""Columns of a sweep's table as pictures want them: lines, a grid, what to write beside them."""

from __future__ import annotations

from rodsim.errors import UsageError
from rodsim.plotting.style import label, pretty_unit
from rodsim.sweep.summary import Summary, as_cell, short


def axis_label(summary: Summary, column: str) -> str:
    """Return the text beside an axis of a picture: a short name with its unit."""
    key = column in summary.plan.key_units
    return label(short_key(column) if key else column.replace("_", " "), summary.unit(column))


def series(summary: Summary, x: str, y: str) -> tuple[list, list, list[str]]:
    """Return two columns and the name of each row's line, of the rows that have both.

    A line is named by the other keys of the sweep, without those that follow from ``x`` and
    the keys before: a table often changes several together.
    """
    rows = [row for row in summary.rows.values() if {x, y} <= row.keys()]
    names: list[tuple[str, ...]] = [()] * len(rows)
    for key in [key for key in summary.plan.key_units if key not in (x, y)]:
        values = [short(row.get(key, "")) for row in rows]
        known = {(short(row[x]), name) for row, name in zip(rows, names, strict=True)}
        told = {(short(row[x]), n, v) for row, n, v in zip(rows, names, values, strict=True)}
        if len(told) > len(known):
            unit = pretty_unit(summary.unit(key))
            texts = [f"{short_key(key)} = {v} {unit}".strip() for v in values]
            names = [(*n, text) for n, text in zip(names, texts, strict=True)]
    columns = [[_plain(row[c]) for row in rows] for c in (x, y)]
    return *columns, [", ".join(name) for name in names]


def check_grid(summary: Summary, x: str, y: str) -> None:
    """Raise UsageError where ``x`` and ``y`` are no keys of numbers, or another key changes too."""
    places = [(run.values.get(x), run.values.get(y)) for run in summary.plan.runs]
    if x == y or not {type(value) for place in places for value in place} <= {int, float}:
        raise UsageError(f"--map {x} {y}: needs two keys of the sweep that are numbers")
    if len({*places}) < len(places):
        raise UsageError(f"--map {x} {y}: several runs have the same values: other keys change")
    if any(len({place[side] for place in places}) < 2 for side in (0, 1)):
        raise UsageError(f"--map {x} {y}: needs two values of each")


def grid(summary: Summary, x: str, y: str, z: str) -> tuple[list, list, list[list[float]]]:
    """Return the values of two keys, in order, and column ``z`` [y][x], NaN where none is."""
    across, up = (sorted({run.values[key] for run in summary.plan.runs}) for key in (x, y))
    rows = [row for row in summary.rows.values() if isinstance(row.get(z), int | float)]
    found = {(row[x], row[y]): row[z] for row in rows}
    return across, up, [[found.get((a, b), float("nan")) for a in across] for b in up]


def short_key(key: str) -> str:
    """Return the end of a key, with what it is an entry of: ``b``, ``strain_twist.2``."""
    parts = key.split(".")
    return ".".join(parts[-2:] if parts[-1].isdigit() else parts[-1:])


def _plain(value):
    return value if isinstance(value, int | float) else as_cell(value)
