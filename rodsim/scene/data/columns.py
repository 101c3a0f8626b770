"""Which columns of a table are meant: by name or number, and the unit in a name."""

from __future__ import annotations

import re

from rodsim.case.words import did_you_mean, one_of
from rodsim.errors import FileError
from rodsim.scene.data.text import TextTable

POSITION = ("x", "y", "z")
TRIAD = tuple(f"D{i}{c}" for i in (1, 2, 3) for c in POSITION)
_UNIT = re.compile(r"\s*[(\[]\s*([^)\]]*?)\s*[)\]]\s*$")


def position_columns(table: TextTable, wanted=None) -> list[int]:
    """Return the columns of x, y, z, or of x, y alone, as 0, 1, ...; raises FileError.

    ``wanted``: names or numbers from 1 on. Without it those called x, y, z, else all of a table
    that has two or three columns, else the first three of one with as many as a rod's triads need.
    """
    if wanted is not None:
        return [find(table, name) for name in wanted]
    named = _named(table, POSITION)
    if len(named) == 3 or (len(named) == 2 and _named(table, ("z",)) == []):
        return named
    if table.width in (2, 3, 12):
        return list(range(min(table.width, 3)))
    raise FileError(f"{table.path}: which of its columns are x, y, z? {_columns(table)}")


def triad_columns(table: TextTable, wanted=None) -> list[int]:
    """Return the twelve columns of x y z D1 D2 D3; raises FileError."""
    if wanted is not None:
        return [find(table, name) for name in wanted]
    named = _named(table, (*POSITION, *TRIAD))
    if len(named) == 12:
        return named
    if table.width == 12:
        return list(range(12))
    raise FileError(
        f"{table.path}: needs the 12 columns x y z D1 D2 D3 (three each), has {table.width}; "
        "a table without triads is kind: curve"
    )


def find(table: TextTable, wanted: str | int) -> int:
    """Return the number, from 0 on, of a column given by name or by number from 1 on."""
    if isinstance(wanted, int):
        if not 1 <= wanted <= table.width:
            raise FileError(f"{table.path}: has the columns 1 to {table.width}, no {wanted}")
        return wanted - 1
    for same in (str, _plain):
        found = [k for k, name in enumerate(table.names) if same(name) == same(wanted)]
        if len(found) == 1:
            return found[0]
        if found:
            raise FileError(
                f"{table.path}: has {len(found)} columns '{wanted}': give their numbers"
            )
    hint = did_you_mean(wanted, table.names) or f": {_columns(table)}"
    raise FileError(f"{table.path}: has no column '{wanted}'{hint}")


def has(table: TextTable, name: str) -> bool:
    """Whether exactly one column has a name."""
    return len(_named(table, (name,))) == 1


def unit_of(table: TextTable, columns: list[int]) -> str | None:
    """Return the unit in brackets that all these columns have in their names, or None."""
    found = {(_UNIT.search(table.names[k]) or [None, None])[1] for k in columns if table.names}
    return found.pop() if len(found) == 1 else None


def _plain(name):
    """Return a name as it is compared: without its unit, signs and capitals."""
    return re.sub(r"[\s_.\-]", "", _UNIT.sub("", name)).casefold()


def _named(table, names):
    plain = [_plain(name) for name in table.names]
    return [plain.index(_plain(name)) for name in names if plain.count(_plain(name)) == 1]


def _columns(table):
    if not table.names:
        return f"it has {table.width} without names: write columns: [2, 3, 4]"
    return f"it has {one_of(table.names)}: write columns: [..]".replace(" or ", " and ")
