"""YAML text -> plain data and the line of every path, without any of YAML's traps.

libyaml splits the text into events; the composer below is ours and iterative. It knows no aliases,
merge keys, tags or several documents, so a small file cannot grow into a large one, and it refuses
duplicate keys instead of keeping the last.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import yaml

from rodsim.case.scalars import plain_scalar
from rodsim.case.words import clipped, dotted
from rodsim.errors import CaseError, Problem

_Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
# all but YAML's printable characters
_NOT_YAML = re.compile("[^\t\n\r -~\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_GLUED = re.compile(r"[A-Za-z_]\w*:[^\s:/]")
DEEPEST = 30
TOO_DEEP = f"nested deeper than {DEEPEST} levels"
MOST_PROBLEMS = 100

Path = tuple[str | int, ...]
Lines = dict[Path, int | None]


@dataclass
class _Container:
    """A mapping or list being filled, and where it sits."""

    value: dict | list
    path: Path
    key: str | None = None  # of a mapping, between a key and its value
    glued: Any = None  # the value of {spacings:4}, where a blank is missing after the colon

    @property
    def wants_key(self) -> bool:
        return isinstance(self.value, dict) and self.key is None


@dataclass
class _Composer:
    """Fills nested dicts and lists from events, one event at a time."""

    where: Callable[[int], str]
    prefix: Path
    root: Any = None
    documents: int = 0
    stack: list[_Container] = field(default_factory=list)
    lines: Lines = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)
    broken: bool = False  # the data are not what was meant: checking them would only mislead

    def note(self, event: yaml.Event, reason: str, path: Path = (), broken: bool = True) -> None:
        """Remember a problem; composing goes on."""
        self.broken |= broken
        place, key = self.where(line_of(event.start_mark)), dotted((*self.prefix, *path))
        self.problems.append(Problem(place, key, None, reason))
        if len(self.problems) >= MOST_PROBLEMS:
            raise CaseError(self.problems)

    def stop(self, event: yaml.Event, reason: str) -> None:
        """Give up on the text: what follows would only repeat the problem."""
        self.note(event, reason, self.stack[-1].path if self.stack else ())
        raise CaseError(self.problems)

    def open_path(self) -> Path:
        """Return the path of the value that is being read."""
        if not self.stack:
            return ()
        inner = self.stack[-1]
        return inner.path if inner.key is None else (*inner.path, inner.key)

    def take(self, event: yaml.Event) -> None:
        """Take the next event."""
        if isinstance(event, yaml.DocumentStartEvent):
            self.documents += 1
            if self.documents > 1:
                self.stop(event, "a second document starts here: write one case per file")
        elif isinstance(event, yaml.CollectionEndEvent):
            self.stack.pop()
        elif isinstance(event, yaml.NodeEvent):
            self._node(event)

    def _node(self, event: yaml.NodeEvent) -> None:
        if event.anchor is not None:
            sign, kind = (
                ("*", "aliases") if isinstance(event, yaml.AliasEvent) else ("&", "anchors")
            )
            self.note(
                event, f"{kind} ({sign}{clipped(event.anchor)}) are not supported in case files"
            )
        if getattr(event, "tag", None) is not None:
            self.note(event, f"tags ({clipped(event.tag)}) are not supported in case files")
        if self.stack and self.stack[-1].wants_key:
            self._key(event)
        elif isinstance(event, yaml.CollectionStartEvent):
            self._open(event)
        else:
            plain = isinstance(event, yaml.ScalarEvent) and event.implicit[0]
            self._place(
                event, plain_scalar(event.value) if plain else getattr(event, "value", None)
            )

    def _key(self, event: yaml.NodeEvent) -> None:
        container = self.stack[-1]
        if not isinstance(event, yaml.ScalarEvent):
            self.stop(event, "a key must be plain text")
        if event.implicit[0] and event.value == "<<":
            self.note(event, "merge keys (<<) are not supported in case files", container.path)
        elif event.implicit[0] and not isinstance(plain_scalar(event.value), str):
            number = isinstance(plain_scalar(event.value), int | float)
            hint = "; is it a decimal comma? decimals have a point" if number else ""
            self.note(event, f"the key {clipped(event.value)} must be text{hint}", container.path)
        key = self._without_value(event)
        path = (*container.path, key)
        if key in container.value:
            first = self.where(self.lines[path])
            self.note(event, f"duplicate key: first given at {first}", path, broken=False)
        container.key = key
        container.value[key] = None
        self.lines[path] = line_of(event.start_mark)

    def _without_value(self, event: yaml.ScalarEvent) -> str:
        """Return the key alone of ``spacings:4``, which YAML takes for a key without a value."""
        if not (event.implicit[0] and _GLUED.match(event.value)):
            return event.value
        key, _, value = event.value.partition(":")
        container = self.stack[-1]
        reason = f"a blank must follow the colon: write '{clipped(key)}: {clipped(value)}'"
        self.note(event, reason, (*container.path, key), broken=False)
        container.glued = plain_scalar(value)
        return key

    def _open(self, event: yaml.CollectionStartEvent) -> None:
        if len(self.stack) >= DEEPEST:
            self.stop(event, TOO_DEEP)
        value = {} if isinstance(event, yaml.MappingStartEvent) else []
        self.stack.append(_Container(value, self._place(event, value)))

    def _place(self, event: yaml.NodeEvent, value: Any) -> Path:
        """Put a value where it belongs and return its path."""
        line = line_of(event.start_mark)
        if not self.stack:
            self.root, path = value, ()
        elif isinstance(self.stack[-1].value, list):
            path = (*self.stack[-1].path, len(self.stack[-1].value))
            self.stack[-1].value.append(value)
        else:
            container = self.stack[-1]
            path = (*container.path, container.key)
            value = container.glued if value is None else value
            container.value[container.key], container.key, container.glued = value, None, None
            line = self.lines[path]  # that of the key, already there
        self.lines[path] = line
        return path


def line_of(mark: yaml.Mark | None) -> int:
    """Return the line number of a place in the text, counted from 1."""
    return 1 if mark is None else mark.line + 1


def parse(text: str, where: Callable[[int], str], prefix: Path = ()) -> tuple[Any, Lines]:
    """Return the data in ``text`` and the line of every path in it.

    ``where`` makes the place shown in a problem from a line number, ``prefix`` starts its key.
    Raises CaseError with every problem found, if any.
    """
    data, lines, problems = compose(text, where, prefix)
    if problems:
        raise CaseError(problems)
    return data, lines


def compose(
    text: str, where: Callable[[int], str], prefix: Path = ()
) -> tuple[Any, Lines, list[Problem]]:
    """Return what ``parse`` does, and the problems that leave the data as they were meant.

    Those are duplicate keys, of which the last counts, and blanks missing after a colon. Raises
    CaseError with every problem found where there are others.
    """
    composer = _Composer(where, prefix)
    try:
        _refuse_odd_characters(text)
        for event in yaml.parse(text, Loader=_Loader):
            composer.take(event)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
        reason = _syntax_reason(error, text)
        path = (*prefix, *composer.open_path()) if reason == TOO_DEEP else prefix
        composer.problems.append(Problem(where(line_of(mark)), dotted(path), None, reason))
        composer.broken = True
    if composer.broken:
        raise CaseError(composer.problems)
    return composer.root, composer.lines, composer.problems


def _refuse_odd_characters(text: str) -> None:
    """Raise what libyaml would, but with the line of the character."""
    odd = _NOT_YAML.search(text)
    if odd is not None:
        line = text.count("\n", 0, odd.start())
        mark = yaml.Mark("", odd.start(), line, 0, None, None)
        problem = f"the character U+{ord(odd[0]):04X} is not allowed"
        raise yaml.MarkedYAMLError(None, None, problem, mark)


def _syntax_reason(error: yaml.YAMLError, text: str) -> str:
    """Return libyaml's words, after what to do about it and where the broken part began."""
    words = getattr(error, "problem", None) or str(error)
    if "nesting depth" in words:  # newer libyaml has a limit of its own, and reads ahead to it
        return TOO_DEEP
    mark, start = getattr(error, "problem_mark", None), getattr(error, "context_mark", None)
    elsewhere = start is not None and mark is not None and start.line != mark.line
    begun = f" (in what begins on line {line_of(start)})" if elsewhere else ""
    hint = ""
    if mark is not None and text[mark.index : mark.index + 1] == "\t":
        hint = "indent with spaces, not tabs: "
    elif "mapping values are not allowed" in words:
        before = text[: mark.index].splitlines()[-2:] if mark else []
        glued = [line.strip() for line in before if _GLUED.match(line.strip())]
        hint = "a ':' too many, or an indent that does not fit: "
        if glued:
            hint = f"a blank must follow the colon in '{clipped(glued[0])}': "
    elif "did not find expected" in words:
        hint = "check indents, commas, quotes and brackets: "
    return f"not valid YAML: {hint}{words}{begun}"
