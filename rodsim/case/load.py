"""Case file -> Case, or a CaseError with every problem at once."""

from __future__ import annotations

import copy
import math
import os
import shlex
from collections.abc import Iterable, Mapping
from typing import Any

from pydantic import TypeAdapter, ValidationError

from rodsim.case.check import Finding, check
from rodsim.case.messages import explain, yaml_path
from rodsim.case.model import Case
from rodsim.case.overrides import apply_overrides
from rodsim.case.places import Place, named
from rodsim.case.slips import below, section_slips
from rodsim.case.source import Source
from rodsim.case.yaml_text import Path, compose
from rodsim.errors import CaseError, Problem, UsageError
from rodsim.files import HDF5_SIGNATURE

LARGEST_FILE = 1_000_000  # bytes; a case is a few hundred
MOST_PROBLEMS = 100


def load_case(path: str | os.PathLike, overrides: Iterable[str] = ()) -> Case:
    """Return the validated case in a YAML file, after overrides such as ``"time.end=0.01"``.

    Raises CaseError, whose ``problems`` name file:line, key, value and reason of all that is wrong.
    """
    if isinstance(overrides, str) or not all(isinstance(text, str) for text in overrides):
        raise UsageError('overrides must be texts in a list, such as ["time.end=0.01"]')
    name = os.fspath(path)
    text = _read(name)
    data, lines, problems = compose(text, lambda line: f"{name}:{line}")
    return _build(Source(name, text, tuple(overrides), data, lines, Place(Case)), problems)


def case_from_mapping(
    data: Mapping[str, Any], overrides: Iterable[str] = (), path: str = "case"
) -> Case:
    """Return the case that plain data describes, such as ``case.resolved()`` of an earlier one.

    ``path`` stands for the file in messages. Raises CaseError as ``load_case`` does.
    """
    root = Place(Case)
    return _build(Source(path, "", tuple(overrides), copy.deepcopy(dict(data)), {}, root), [])


def _read(name: str) -> str:
    """Return the text of a file; raise CaseError if that is impossible."""
    try:
        with open(name, "rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        reason = getattr(error, "strerror", None) or str(error)
        raise CaseError([Problem(name, "", None, f"cannot read: {reason}")]) from None
    if len(data) > LARGEST_FILE and not data.startswith(HDF5_SIGNATURE):
        reason = f"larger than {LARGEST_FILE} bytes: this is not a case file"
        raise CaseError([Problem(name, "", None, reason)])
    if data.startswith(HDF5_SIGNATURE):
        quoted = shlex.quote(name)
        reason = f"is an output, not a case: go on with rodsim resume {quoted}, or see rodsim info"
        raise CaseError([Problem(name, "", None, f"{reason} {quoted}")])
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        reason = f"not UTF-8 text: byte 0x{data[error.start]:02x}"
        raise CaseError([Problem(f"{name}:{line}", "", None, reason)]) from None


def _build(source: Source, problems: list[Problem]) -> Case:
    """Apply the overrides, validate each section, check across sections."""
    if not isinstance(source.data, dict):
        found = "is empty" if source.data is None else "has no keys"
        reason = f"the file {found}: a case needs fluid, rods and time (see 'rodsim new')"
        raise CaseError([Problem(source.where(()), "", None, reason)])
    problems = problems + apply_overrides(source)
    case, wrong = _validate(source)
    errors, warnings = check(case, _rod_names(source))
    problems += wrong
    problems += _placed(errors, source)
    if problems:
        raise CaseError(_in_order(problems))
    case._source, case._warnings = source, tuple(_placed(warnings, source))
    return case


def _placed(findings: list[Finding], source: Source) -> list[Problem]:
    return [source.problem(path, reason) for path, reason in findings]


def _validate(source: Source) -> tuple[Case, list[Problem]]:
    """Return the case and no problems, or what validated of it and all problems."""
    data = without_nulls(source.data, source.root)
    context = {"parameters": _parameters(data)}
    try:
        return Case.model_validate(data, context=context), []
    except ValidationError as error:
        details = error.errors(include_url=False, include_input=False)
    slips = section_slips(source)
    bad = [yaml_path(detail["loc"], source.data) for detail in details]
    told = [d for d, path in zip(details, bad, strict=True) if not below(path, slips)]
    problems = [*slips.values(), *(explain(detail, source) for detail in told[:MOST_PROBLEMS])]
    return _valid_part(data, bad, context), list(dict.fromkeys(problems))


def _valid_part(data: dict, bad: list[Path], context: dict) -> Case:
    """Return a Case of the sections, rods and tracer groups that validated; others are None."""
    parts = {}
    for name, field in Case.model_fields.items():
        inside = {path[1] for path in bad if path[0] == name and len(path) > 1}
        if (name,) in bad or (inside and not named(Place(Case).child(name))):
            parts[name] = None
        elif name in data:
            section = data[name]
            if inside:
                section = {key: item for key, item in section.items() if key not in inside}
            adapter = TypeAdapter(field.annotation)
            parts[name] = adapter.validate_python(section, context=context)
    if any(path[0] == "parameters" for path in bad):
        parts["parameters"] = None
    return Case.model_construct(**parts)


def without_nulls(node: Any, place: Place | None) -> Any:
    """Return mappings without keys set to null: an empty ``output:`` is one left out.

    The user's own names stay: ``rods: {tail: }`` is a rod with nothing in it, not no rod.
    """
    if not isinstance(node, dict):
        return node
    keep = place is not None and named(place)
    below = {key: place and place.child(key, node) for key in node}
    return {
        key: without_nulls(item, below[key])
        for key, item in node.items()
        if keep or item is not None
    }


def _parameters(data: dict) -> dict[str, float]:
    """Return the values expressions are bound to; nan for what is no number, refused anyway."""
    given = data.get("parameters")
    values = {}
    for name, value in (given if isinstance(given, dict) else {}).items():
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        values[name] = float(value) if is_number else math.nan
    return values


def _rod_names(source: Source) -> list[str]:
    rods = source.value(("rods",))
    named_so = isinstance(rods, dict) and not section_slips(source)
    return list(rods) if named_so else []


def _in_order(problems: list[Problem]) -> list[Problem]:
    """Return the problems by line, those of options first, up to a limit."""

    def line(problem: Problem) -> int:
        number = problem.where.rpartition(":")[2]
        return int(number) if number.isdecimal() else 0

    ordered = sorted(problems, key=line)
    left = len(ordered) - MOST_PROBLEMS
    return ordered[:MOST_PROBLEMS] + (
        [Problem("", "", None, f"and {left} more")] if left > 0 else []
    )
