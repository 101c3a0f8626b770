"""Case file -> Case, or a CaseError with every problem at once."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from pydantic import TypeAdapter, ValidationError

from rodsim.case.check import Finding, check
from rodsim.case.copies import expand
from rodsim.case.messages import explain, yaml_path
from rodsim.case.model import Case
from rodsim.case.numbers import Numbers
from rodsim.case.overrides import apply_overrides
from rodsim.case.places import Place, named
from rodsim.case.plain import override_texts, plain
from rodsim.case.slips import below, section_slips
from rodsim.case.source import Source
from rodsim.case.words import did_you_mean
from rodsim.case.yaml_text import Path, compose
from rodsim.errors import CaseError, Problem, UsageError
from rodsim.files import HDF5_SIGNATURE

LARGEST_FILE = 1_000_000  # bytes; a case is a few hundred
MOST_PROBLEMS = 100


def load_case(
    case: str | os.PathLike[str] | Mapping[str, Any],
    overrides: Iterable[str] | Mapping[str, Any] = (),
) -> Case:
    """Return the validated case in a YAML file, or in a mapping that has what such a file has.

    ``overrides`` : a list of texts, ``["time.end=0.01"]``, or a mapping, ``{"time.end": 0.01}``, as
    ``--set`` takes them. Numbers and arrays may be NumPy's. Files that a mapping names lie in the
    current folder. Raises CaseError, whose ``problems`` name file:line, key, value and reason of
    all that is wrong.
    """
    texts = override_texts(overrides)
    if isinstance(case, Mapping):
        return case_from_mapping(case, texts)
    if isinstance(case, Case) or not isinstance(case, str | os.PathLike):
        raise UsageError(
            f"load_case takes the path of a file or a dict, not {type(case).__name__}"
            + ("; of a case: case.resolved()" if isinstance(case, Case) else "")
        )
    name = os.fspath(case)
    text = _read(name)
    data, lines, problems = compose(text, lambda line: f"{name}:{line}")
    return _build(Source(name, text, texts, data, lines, Place(Case)), problems)


def case_from_mapping(
    data: Mapping[str, Any], overrides: Iterable[str] = (), path: str = "case"
) -> Case:
    """Return the case that plain data describes, such as ``case.resolved()`` of an earlier one.

    ``path`` stands for the file in messages. Raises CaseError as ``load_case`` does.
    """
    root = Place(Case)
    return _build(Source(path, "", tuple(overrides), plain(data), {}, root), [])


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
    wrong, late = apply_overrides(source, source.overrides)
    problems = problems + wrong
    names = _rod_names(source)
    numbers = Numbers(source)
    if unmade := expand(source, numbers.scope):
        numbers.failed.add(("rods",))  # there may be none now
    problems += unmade + apply_overrides(source, late)[0]
    case, wrong = _validate(source, numbers)
    errors, warnings = check(case, [*_rod_names(source), *names])
    problems += numbers.problems + wrong + _placed(errors, source)
    if problems:
        raise CaseError(_in_order(_once(problems, source)))
    warnings += _unused(source, numbers)
    case._source, case._warnings = source, tuple(_once(_placed(warnings, source), source))
    return case


def _placed(findings: list[Finding], source: Source) -> list[Problem]:
    return [source.problem(path, reason) for path, reason in findings]


def _once(problems: list[Problem], source: Source) -> list[Problem]:
    """Return problems without those that a rod has only because it is like another."""

    def told(problem: Problem) -> tuple:
        rod, _, below = problem.key.removeprefix("rods.").partition(".")
        return rod in source.origins, (problem.where, below, problem.reason)

    seen = {what for copied, what in map(told, problems) if not copied}
    found = []
    for problem in problems:
        copied, what = told(problem)
        if not (copied and what in seen):
            found.append(problem)
        seen.add(what)
    return found


def _unused(source: Source, numbers: Numbers) -> Iterator[Finding]:
    """A parameter that only ``--set`` has, and that nothing uses, may be a slip of the keys."""
    for name in source.added:
        if name not in numbers.used and source.value(("parameters", name)) is not None:
            others = [other for other in numbers.scope.values if other not in source.added]
            hint = did_you_mean(name, others)
            yield ("parameters", name), f"nothing uses this new parameter{hint}"


def _validate(source: Source, numbers: Numbers) -> tuple[Case, list[Problem]]:
    """Return the case and no problems, or what validated of it and all problems."""
    data = without_nulls(numbers.data(), source.root)
    try:
        return Case.model_validate(data), []
    except ValidationError as error:
        details = error.errors(include_url=False, include_input=False)
    slips = section_slips(source)
    bad = [yaml_path(detail["loc"], source.data) for detail in details]
    told = {*slips, *numbers.failed}
    new = [d for d, path in zip(details, bad, strict=True) if path not in told]
    new = [d for d in new if not below(yaml_path(d["loc"], source.data), slips)]
    problems = [*slips.values(), *(explain(detail, source) for detail in new[:MOST_PROBLEMS])]
    return _valid_part(data, bad), list(dict.fromkeys(problems))


def _valid_part(data: dict, bad: list[Path]) -> Case:
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
            parts[name] = None if inside and not section else adapter.validate_python(section)
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
