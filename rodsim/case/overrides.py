"""``--set a.b.c=value``: change the data of a case before it is validated."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice
from typing import Any

from rodsim.case.copies import inherited, is_late
from rodsim.case.places import Place, named
from rodsim.case.source import OVERRIDE, Source, child
from rodsim.case.words import clipped, did_you_mean, dotted, one_of
from rodsim.case.yaml_text import parse
from rodsim.errors import CaseError, Problem

MOST_PLACES = 3  # that a message names


class _Refused(Exception):
    """Why an override cannot be applied."""


class _UnknownKey(Exception):
    """The model has no such key; ``hint`` names what it has there."""

    def __init__(self, hint: str):
        super().__init__(hint)
        self.hint = hint


def apply_overrides(source: Source, texts: Iterable[str]) -> tuple[list[Problem], list[str]]:
    """Apply overrides in order to ``source.data``; return what is wrong with them.

    Keys that are there are replaced, or removed by ``null``. Keys that are not are added if the
    model has them, and so are parameters; new rods and tracer groups are refused. What changes one
    copy of a repeated rod is returned as well: it can be applied when the copies are there.
    """
    problems, late = [], []
    for text in texts:
        key, equals, value = text.partition("=")
        key = key.strip()
        try:
            if not equals or not key:
                raise _Refused("must be written key=value, as in --set time.end=0.01")
            if not value.strip():
                raise _Refused("has no value after '=': write null to remove the key")
            parts = tuple(key.split("."))
            data, _ = parse(value, lambda line: OVERRIDE, parts)
            if is_late(parts, source.data):
                late.append(text)
            else:
                _put(source, parts, data)
        except _UnknownKey as unknown:
            found = _places(source.data, source.root, parts)
            places = [f"'{dotted(path)}'" for path in islice(found, MOST_PLACES)]
            longer = f": did you mean {one_of(places)}?" if places else unknown.hint
            problems.append(Problem(OVERRIDE, clipped(key), None, f"unknown key{longer}"))
        except _Refused as refused:
            shown_key = clipped(key if equals else text)
            problems.append(Problem(OVERRIDE, shown_key, None, str(refused)))
        except CaseError as error:
            problems += error.problems
    return problems, late


def _put(source: Source, parts: tuple[str, ...], value: Any) -> None:
    """Walk to the last key but one, adding what the model knows on the way, and set the last."""
    node, place, path = source.data, source.root, ()
    for part in parts[:-1]:
        key, below = _step(node, place, part, path)
        path = (*path, key)
        if isinstance(node, dict) and node.get(key) is None:
            above = inherited(source.data, path)
            entries = above if isinstance(above, list) else below.default
            node[key] = list(entries) if isinstance(entries, list | tuple) else {}
            source.lines[path] = None
        node, place = node[key], below
    key, _ = _step(node, place, parts[-1], path)
    path = (*path, key)
    if path[:-1] == ("parameters",) and key not in node:
        source.added.append(key)
    for known in [known for known in source.lines if known[: len(path)] == path]:
        del source.lines[known]
    if value is None and isinstance(node, dict):
        node.pop(key, None)
    else:
        node[key] = value
    source.lines[path] = None


def _step(node: Any, place: Place, part: str, path: tuple) -> tuple[str | int, Place]:
    """Return the key or index one step on, and what the model expects there."""
    here = dotted(path) or "the case"
    if isinstance(node, list):
        if not part.isdecimal() or int(part) >= len(node):
            raise _Refused(f"{here} has the entries 0 to {len(node) - 1}")
        key = int(part)
    elif isinstance(node, dict):
        key = part
        if named(place) and key not in node and not _is_parameters(place):
            raise _Refused(f"{here} has no '{clipped(key)}'{_near(key, list(node))}")
    else:
        raise _Refused(f"{here} is a single value here: set it as a whole")
    below = place.child(key, node)
    if below is None:
        keys = place.keys(node)
        raise _UnknownKey(_near(part, keys))
    return key, below


def _places(node: Any, place: Place, end: tuple[str, ...], path: tuple = ()) -> Iterator[tuple]:
    """Yield the paths of the model, with the names of this case, that end in some keys."""
    if path[-len(end) :] == end and len(path) > len(end):
        yield path
    for key in list(node if isinstance(node, dict) else ()) if named(place) else place.keys(node):
        if below := place.child(key, node):
            yield from _places(child(node, key), below, end, (*path, key))


def _is_parameters(place: Place) -> bool:
    """Whether the user's names here are those of numbers, which may be added."""
    below = place.child("")
    return below is not None and below.takes_numbers()


def _near(word: str, choices: list[str]) -> str:
    if not choices:
        return ": there is none"
    return did_you_mean(word, choices) or f": there is {one_of(list(choices))}"
