"""Named arrays as .npz or as columns of a .csv."""

from __future__ import annotations

import csv

import numpy as np

from rodsim.files import replacing
from rodsim.progress import Silent

COMPONENTS = "xyz"


def write_npz(path, arrays: dict) -> None:
    """Write arrays, and texts, under their names; ``numpy.load`` reads them. Raises FileError."""
    with replacing(path) as temporary:
        np.savez(temporary, **arrays)


def write_csv(path, heads, blocks, share=None, progress=None) -> None:
    """Write a table block by block, each a list of columns, with full precision.

    ``share``: number of blocks, for the progress. Raises FileError.
    """
    progress = progress or Silent()
    with replacing(path) as temporary, open(temporary, "w", newline="", encoding="utf-8") as stream:
        out = csv.writer(stream)
        out.writerow(heads)
        for number, block in enumerate(blocks, start=1):
            out.writerows(zip(*(column.tolist() for column in block), strict=True))
            if share:
                progress.update(number / share)


def component_heads(name: str, unit: str) -> list[str]:
    """Return the heads of a vector's three columns: ``velocity_x (um s^-1)``, ...

    >>> component_heads("", "um")
    ['x (um)', 'y (um)', 'z (um)']
    """
    stem = f"{name}_" if name else ""
    return [head(f"{stem}{c}", unit) for c in COMPONENTS]


def head(name: str, unit: str) -> str:
    """Return the head of a column, with the unit where there is one."""
    return name if unit in ("", "1") else f"{name} ({unit})"
