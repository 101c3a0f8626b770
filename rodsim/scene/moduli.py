"""Elastic moduli along a rod, at the middle of each segment."""

from dataclasses import replace

import numpy as np

from rodsim.case.fields import LARGEST, SMALLEST
from rodsim.compiled.parts import PartList
from rodsim.forces.elastic import elastic_part
from rodsim.nodes import Rods


def moduli_along(moduli, spacing: float, segments: int) -> np.ndarray:
    """Return a_1, a_2, a_3, b_1, b_2, b_3 of each segment, (6, S), at s = (k + 1/2) ds."""
    s = (np.arange(segments) + 0.5) * spacing
    rows = [value(s) if callable(value) else np.full(segments, value) for value in moduli.values]
    return np.array(rows)


def typical(along: np.ndarray) -> np.ndarray:
    """Return one value (6,) for each row (6, S): the value itself where all are the same."""
    return np.where(np.ptp(along, axis=1) > 0.0, along.mean(axis=1), along[:, 0])


def along_rods(case, found, rods) -> np.ndarray | None:
    """Return moduli and rest strains of all segments, (9, N), or None where no rod asks for them.

    Rows 0-5: a_1, a_2, a_3, b_1, b_2, b_3; rows 6-8: shear and stretch at rest, of the rods that
    are at rest as they are built. 0 for the segment that an open rod has not.
    """
    natural = {name: arrays["natural"] for name, arrays in found.arrays.items()
               if "natural" in arrays}  # fmt: skip
    if not natural and not any(rod.moduli.vary for rod in case.rods.values()):
        return None
    table = np.zeros((9, rods.points))
    for rod, moduli in zip(rods, found.moduli, strict=True):
        segments = slice(rod.first, rod.first + rod.segments)
        table[:6, segments] = moduli
        if rod.name in natural:
            table[6:, segments] = natural[rod.name][:, 3:].T
    return table


def check_moduli(moduli, along: np.ndarray, spacing: float):
    """Yield (path below the rod, reason) where moduli along a rod are not positive."""
    for key, row in zip(moduli.keys, along, strict=True):
        bad = ~((row >= SMALLEST) & (row <= LARGEST))
        if bad.any():
            k = int(np.argmax(bad))
            at = f"is {row[k]:.4g} at s = {(k + 0.5) * spacing:.4g}"
            yield ("moduli", key), f"{at}: must be between {SMALLEST:g} and {LARGEST:g} everywhere"


def with_moduli(scene, factors: np.ndarray):
    """Return a scene with a_1, a_2, a_3, b_1, b_2, b_3 of all rods times ``factors`` (6,)."""
    rods = Rods(replace(rod, moduli=tuple(factors * rod.moduli)) for rod in scene.rods)
    along = scene.along
    if along is not None:
        along = np.concatenate([along[:6] * factors[:, None], along[6:]])
    changed = replace(scene, rods=rods, along=along)
    parts = (elastic_part(changed) if part.name == "elastic" else part for part in scene.parts)
    return replace(changed, parts=PartList(parts))
