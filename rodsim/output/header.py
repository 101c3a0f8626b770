"""The head of an output file: what it is, the case it was made from, its rods."""

from __future__ import annotations

from typing import Any

import numpy as np

from rodsim.errors import FileError
from rodsim.nodes import Rod, Rods
from rodsim.output import layout
from rodsim.output.guarded import GuardedFile

UNKNOWN = (-1, "")  # numbers of /runtime that a run has not had yet


def header_of(file: GuardedFile, path) -> dict[str, Any]:
    """Return the attributes of a trajectory that its head says, by name; raises FileError."""
    try:
        ours = file.attribute("/", "filetype", str) == layout.FILETYPE
    except FileError:
        ours = False
    if not ours:
        raise FileError(f"{path}: not a rodsim output")
    number = file.attribute("/", "format", int)
    if number > layout.FORMAT:
        raise FileError(
            f"{path}: has format {number}, of a newer rodsim; this one reads up to {layout.FORMAT}"
        )
    found = {key: file.attribute("/", key, str) for key in ("status", "version", "created")}
    if found["status"] not in layout.STATUS:
        raise file.damaged(f"its status is {found['status']!r}")
    return {"format": number, **found, **_case_of(file), "runtime": _runtime_of(file)}


def _case_of(file):
    units = {
        kind: file.attribute("case", f"{kind}_unit", str) for kind in ("length", "mass", "time")
    }
    return {
        "case_source": file.text("case/source"),
        "case_resolved": file.text("case/resolved"),
        "inputs": file.text("case/inputs") if "inputs" in file.names("case") else "",
        "overrides": file.texts("case/overrides"),
        "resumes": [text for text in file.texts("case/resumes") if text],
        "units": units,
    }


def _runtime_of(file):
    runtime = file.attributes("runtime").items()
    return {k: v for k, v in runtime if v not in UNKNOWN and v == v}  # NaN is not itself


def rods_of(file: GuardedFile) -> Rods:
    """Return the rods of a file in order, each beginning where one ends; raises FileError."""
    get, found = file.attribute, []
    for name in file.names("rods"):
        where = f"rods/{name}"
        index, start, count = (get(where, key, int) for key in ("index", "first", "count"))
        closed, spacing = get(where, "closed", bool), get(where, "spacing", float)
        moduli = tuple(get(where, "moduli", float, (6,)).tolist())
        found.append((index, where, Rod(name, start, count, closed, spacing, moduli)))
    rods, first = [], 0
    for _, where, rod in sorted(found, key=lambda rod: rod[0]):
        if rod.first != first or rod.count < 1:
            raise file.damaged(f"{where} does not follow the rod before it")
        if not all(0.0 < number < np.inf for number in (rod.spacing, *rod.moduli)):
            raise file.damaged(f"{where} has a spacing or moduli that no rod can have")
        rods.append(rod)
        first += rod.count
    return Rods(rods)
