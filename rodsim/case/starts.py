"""A case that starts from an output: the shapes in it in place of its own."""

from __future__ import annotations

import json
from pathlib import Path

from rodsim.case.model import Case
from rodsim.errors import UsageError


def shapes_of(case: Case, source, frame: int) -> list[str]:
    """Return the overrides that put the shapes in an output in place of those of a case.

    Spacing and closure stay the case's, and must agree. Raises UsageError for rods that are free of
    stress as they are built: they would be so in any other shape.
    """
    found = []
    for name, rod in case.rods.items():
        if rod.strain_twist == "natural":
            reason = "is natural, which another start would change: give numbers, or start from "
            raise UsageError(f"--from: rods.{name}.strain_twist {reason}the output itself")
        path = str(Path(source).absolute())
        shape = {"kind": "file", "path": path, "frame": frame, "rod": name}
        if rod.shape.ds is not None:
            shape |= {"spacing": rod.shape.ds, "closed": rod.shape.is_closed}
        found.append(f"rods.{name}.shape={json.dumps(shape)}")
        if rod.perturb is not None:
            found.append(f"rods.{name}.perturb=null")
    return found
