"""pydantic's errors -> Problems in plain words, at the keys of the file."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import Any

from pydantic_core import ErrorDetails

from rodsim.case.source import OVERRIDE, Source
from rodsim.case.words import clipped, did_you_mean, one_of
from rodsim.case.yaml_text import Path
from rodsim.errors import Problem

_NAME_RULE = "a name is made of letters, digits and _, and does not begin with a digit"
_UNIT_RULE = "must be a short name of letters"
_GLUED = re.compile(r"[A-Za-z_]\w*:[^\s:/].*")
_BOUNDS = {
    "greater_than": "> {gt:g}",
    "greater_than_equal": ">= {ge:g}",
    "less_than": "< {lt:g}",
    "less_than_equal": "<= {le:g}",
}


def explain(error: ErrorDetails, source: Source) -> Problem:
    """Return the Problem that one pydantic error stands for."""
    path = yaml_path(error["loc"], source.data)
    kind, value = error["type"], source.value(path)
    if kind == "missing" and isinstance(path[-1], int):  # too few entries in a list
        path, kind = path[:-1], "too_short"
    place = source.place(path)
    if kind.startswith("union_tag") and isinstance(value, dict) and place and place.kinds():
        return _wrong_kind(path, source)
    if kind == "extra_forbidden":
        return replace(source.problem(path, _unknown_key(path, source)), value=None, unit="")
    if error["loc"][-1] == "[key]":
        reason = str(error["ctx"]["error"]) if kind == "value_error" else _NAME_RULE
        return replace(source.problem(path, reason), value=None, unit="")
    problem = source.problem(path, "")
    rule, advice = _reason(kind, error, source, path)
    if advice is None:  # about this value alone
        return replace(problem, reason=rule)
    return replace(problem, reason=f"{rule}{problem.in_unit}{advice}", unit="")


def yaml_path(loc: tuple, data: Any) -> Path:
    """Return pydantic's location without the tags of unions, which are no keys of the file."""
    path, node = [], data
    for part in loc:
        here = isinstance(node, dict) and part in node
        inside = isinstance(node, list) and isinstance(part, int)
        is_tag = isinstance(part, str) and (part == "[key]" or part.startswith("<"))
        if is_tag and not here:
            continue
        path.append(part)
        node = node[part] if here or (inside and part < len(node)) else None
    return tuple(path)


def _reason(kind: str, error: ErrorDetails, source: Source, path: Path) -> tuple[str, str | None]:
    """Return the rule that is broken, read in the place's unit, and what to write instead.

    The advice is None where the words are about the value and not about the place.
    """
    place, value = source.place(path), source.value(path)
    context, noun = error.get("ctx", {}), place.noun() if place else "something else"
    if kind == "missing":
        return f"missing: needs {noun}", ""
    if kind == "value_error":
        return str(context["error"]), None
    if kind in _BOUNDS:
        return f"must be {_BOUNDS[kind].format(**context)}", ""
    if kind == "finite_number":
        return "must be finite", ""
    if kind == "string_pattern_mismatch":
        return (_UNIT_RULE if "A-Za-zµ" in context["pattern"] else _NAME_RULE), ""
    if kind == "literal_error":
        return f"must be {noun}", did_you_mean(str(value), place.choices() if place else ())
    if kind in ("too_short", "string_too_short") and not value:
        return "must not be empty", ""
    return f"must be {noun}", _hint(noun, value, source.where(path) == OVERRIDE)


def _hint(noun: str, value: Any, option: bool) -> str:
    """Return what to write instead, where it is plain."""
    if isinstance(value, float) and noun == "a whole number" and value.is_integer():
        return f": write {int(value)}"
    if isinstance(value, str) and "number" in noun and _is_number(value):
        return ", without quotes"
    if isinstance(value, str) and "mapping" in noun and _GLUED.fullmatch(value):
        key, _, rest = value.partition(":")
        return f": a blank must follow the colon: write '{key}: {clipped(rest)}'"
    if isinstance(value, list) and "list" not in noun and option:
        return ": one run has one value; rodsim sweep runs over a list"
    if noun == "text" and isinstance(value, int | float):
        return ": put it in quotes"
    return ""


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def _wrong_kind(path: Path, source: Source) -> Problem:
    """Return the Problem of a shape whose ``kind`` is missing or unknown."""
    kinds = source.place(path).kinds()
    given = source.value((*path, "kind"))
    hint = did_you_mean(given, kinds) if isinstance(given, str) else ""
    start = "missing: " if given is None else ""
    return source.problem((*path, "kind"), f"{start}must be one of {', '.join(kinds)}{hint}")


def _unknown_key(path: Path, source: Source) -> str:
    place, above = source.place(path[:-1]), source.value(path[:-1])
    keys = place.keys(above) if place else []
    hint = did_you_mean(str(path[-1]), keys)
    return f"unknown key{hint or ': allowed are ' + one_of(keys) if keys else ''}"
