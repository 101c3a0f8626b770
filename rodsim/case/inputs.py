"""Which files a case is made from, beside itself: shapes and tables of its rods, an earlier run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

NAMED = ("path", "table")  # keys under a rod whose text is the name of a file


def input_entries(data: dict[str, Any]) -> Iterator[tuple[str, dict, str]]:
    """Yield dotted key, the mapping it is in, and its name there, of every file a case names.

    ``data`` is what ``Case.resolved()`` returns.
    """
    for name, rod in data["rods"].items():
        yield from _inside(rod, f"rods.{name}")
    if "initial" in data:
        yield "initial.path", data["initial"], "path"


def _inside(node, path):
    entries = node.items() if isinstance(node, dict) else enumerate(node)
    for key, item in entries:
        where = f"{path}.{key}"
        if key in NAMED and isinstance(item, str):
            yield where, node, key
        elif isinstance(item, dict | list):
            yield from _inside(item, where)
