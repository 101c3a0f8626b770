"""Slips that break a whole section: said once, instead of what every key of it gets wrong."""

from __future__ import annotations

from rodsim.case.model import Rod
from rodsim.case.source import Source
from rodsim.case.words import one_of
from rodsim.case.yaml_text import Path
from rodsim.errors import Problem

TELLING = ("shape", "moduli")  # what every rod has


def section_slips(source: Source) -> dict[Path, Problem]:
    """Return the problem of each section whose keys need not be looked at one by one."""
    rods = source.value(("rods",))
    found = {}
    if isinstance(rods, dict) and _is_a_rod(rods):
        keys = one_of(list(rods)).replace(" or ", " and ")
        reason = f"missing: the name of the rod, a line 'NAME:' between rods and {keys}"
        found["rods",] = source.problem(("rods",), reason)
    elif isinstance(rods, list) and all(isinstance(rod, dict) for rod in rods):
        reason = "must be a mapping of names, not a list: write 'NAME:' instead of each '-'"
        found["rods",] = source.problem(("rods",), reason)
    return {path: _without_value(problem) for path, problem in found.items()}


def below(path: Path, sections: dict[Path, Problem]) -> bool:
    """Tell whether a path lies in one of these sections."""
    return any(path[: len(section)] == section for section in sections)


def _is_a_rod(rods: dict) -> bool:
    """Tell a rod without its name from rods that are called as its keys are."""
    named_so = [rods[key] for key in TELLING if key in rods]
    keys = set(rods) <= set(Rod.model_fields)
    return bool(named_so) and keys and not any(_has(item, TELLING) for item in named_so)


def _has(item: object, keys: tuple[str, ...]) -> bool:
    return isinstance(item, dict) and any(key in item for key in keys)


def _without_value(problem: Problem) -> Problem:
    return Problem(problem.where, problem.key, None, problem.reason)
