"""The rods of a case, one by one: built or read, placed, and held against what the case says."""

from dataclasses import dataclass, field, replace

import numpy as np

from rodsim.blocks.ends import ENDS
from rodsim.case import check_strain_twist, thin
from rodsim.errors import CaseError, FileError
from rodsim.scene.curve import build_curve
from rodsim.scene.geometry import check_rounding
from rodsim.scene.moduli import check_moduli, moduli_along
from rodsim.scene.perturb import perturb
from rodsim.scene.shapes import FORMULAS, place
from rodsim.scene.stored import Built, read_shape
from rodsim.scene.strain import bind, check_reach

READERS = {"file": read_shape, "curve": build_curve}


@dataclass
class RodsBuilt:
    """Rods as built: (position, director, spacing, closed) of each, its strain twist, its arrays.

    ``entries``: three numbers or functions of s and t for each rod. ``moduli``: (6, S) of each, at
    the middle of its segments. ``arrays``: by rod, what the
    strain twist was made from, for the output. ``warnings``: Problems.
    """

    rods: list = field(default_factory=list)
    entries: list = field(default_factory=list)
    moduli: list = field(default_factory=list)
    arrays: dict = field(default_factory=dict)
    warnings: list = field(default_factory=list)


def build_rods(case, stored=None) -> RodsBuilt:
    """Return the rods of a case; raises CaseError and FileError.

    ``stored``: an earlier run of this case, whose ``shape(name, shape)`` returns position,
    director, spacing, closed of a rod that is not to be built again, or None, and whose
    ``arrays(name)`` returns what its strain twist was made from.
    """
    found, problems = RodsBuilt(), []
    for name, rod in case.rods.items():
        built = _build(case, name, rod, stored)
        if not built.errors:
            _bind(case, name, rod, built, stored, found)
        problems += _placed(case, name, built.errors)
        found.warnings += _placed(case, name, built.warnings)
    if problems:  # what looked wrong may be why: a unit, say
        hints = [replace(hint, reason=f"warning: {hint.reason}") for hint in found.warnings]
        raise CaseError([*problems, *hints])
    return found


def _placed(case, name, findings):
    """Yield Problems of (key, reason): a key of the shape, or a path below the rod or the case."""
    for key, reason in findings:
        path = ("rods", name, "shape", key) if isinstance(key, str) else ("rods", name, *key)
        yield case.source.problem(key[1:] if key[0] == "" else path, reason)


def _build(case, name, rod, stored):
    """Return one rod, placed."""
    shape = rod.shape
    before = stored.shape(name, shape) if stored is not None else None
    if before is not None:
        return Built(*before)
    if shape.kind in READERS:
        folder = case.folder
        try:
            with np.errstate(all="ignore"):  # what is too large is refused below
                built = READERS[shape.kind](shape, folder, case.units.length)
        except FileError as error:
            where = case.source.problem(("rods", name, "shape", "path"), str(error))
            raise FileError(str(where)) from error
    else:
        built = Built(*FORMULAS[shape.kind](shape), shape.ds, shape.is_closed)
    built.position, built.director = place(built.position, built.director, shape)
    if not built.errors:
        errors, warnings = check_rounding(built.position, built.spacing)
        built.errors += [("origin", reason) for reason in errors]
        built.warnings += [("origin", reason) for reason in warnings]
    return built


def _disturb(case, name, how, built):
    """Disturb a rod as it is built; what is natural to it stays that of before."""
    shape = built.position, built.director, built.spacing, built.closed
    try:
        built.position, built.director = perturb(*shape, how, case.plane is not None)
    except ValueError as error:
        problem = case.source.problem(("rods", name, "perturb"), str(error))
        raise CaseError([problem]) from error


def _bind(case, name, rod, built, stored, found):
    """Bind the rod's strain twist, and check what the case alone could not tell."""
    folder = case.folder
    kept = None if stored is None else stored.arrays(name)
    try:
        entries, arrays = bind(rod, built, folder, kept)
    except FileError as error:
        where = case.source.problem(("rods", name, "strain_twist"), str(error))
        raise FileError(str(where)) from error
    if case.plane is not None and rod.strain_twist == "natural":
        entries = (entries[0], 0.0, 0.0)
    segments = built.position.shape[1] - (not built.closed)
    end = case.time.end
    along = moduli_along(rod.moduli, built.spacing, segments)
    built.errors += dict.fromkeys(check_moduli(rod.moduli, along, built.spacing))
    built.errors += dict.fromkeys(check_reach(rod, entries, built.spacing, segments, end))
    if not built.errors and (rod.needs_data or rod.shape.ds is None):
        errors, warnings = check_strain_twist(entries, built.spacing, segments, end)
        built.errors += errors
        built.warnings += warnings
    if rod.shape.ds is None and (reason := thin(case.fluid.epsilon, name, built.spacing)):
        built.warnings.append((("", "fluid", "epsilon"), reason))
    before = stored is not None and stored.shape(name, rod.shape) is not None
    if rod.perturb is not None and not (built.errors or before):
        _disturb(case, name, rod.perturb, built)
    found.rods.append((built.position, built.director, built.spacing, built.closed))
    found.entries.append(entries)
    found.moduli.append(along)
    if arrays := {**arrays, **_held(rod, kept)}:
        found.arrays[name] = arrays


def _held(rod, kept):
    """Return where held ends were built in an earlier run: later frames have them elsewhere."""
    names = {f"held_{which}" for which in ENDS if getattr(rod, which) is not None}
    return {name: array for name, array in (kept or {}).items() if name in names}
