"""Wherever the model wants a number, a text is an expression of the parameters: its number.

The data as written stay in the source, for messages; the model gets plain numbers. Texts that stay
expressions, as those of the strain twist, take the numbers of the parameters with them.
"""

from __future__ import annotations

import math
import re
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

from rodsim.case.expressions import ExpressionError, names_in
from rodsim.case.fields import ScopedText
from rodsim.case.parameters import Scope, work_out
from rodsim.case.places import Place
from rodsim.case.source import Source
from rodsim.case.words import clipped, did_you_mean
from rodsim.case.yaml_text import Path
from rodsim.errors import Problem

_WORD = re.compile(r"\s*[A-Za-z_][A-Za-z0-9_]*\s*")


@dataclass
class Numbers:
    """The data of a source with numbers for texts, and what went wrong in making them.

    ``failed``: paths that have no number; the model refuses the nan there, and says nothing new.
    ``used``: the names that the texts use. ``scope``: the parameters of the case.
    """

    source: Source
    problems: list[Problem] = field(default_factory=list)
    failed: set[Path] = field(default_factory=set)
    used: set[str] = field(default_factory=set)

    def __post_init__(self):
        self.scope = self._parameters(self.source.data.get("parameters"), ("parameters",), {})

    def data(self) -> dict[str, Any]:
        """Return the data with plain numbers."""
        return self._mapping(self.source.data, self.source.root, (), self.scope)

    def _node(self, node: Any, place: Place | None, path: Path, scope: Scope) -> Any:
        """Return a value of the file with numbers for the expressions in it."""
        if place is None:
            return node
        if isinstance(node, dict):
            if path[:1] == ("rods",) and len(path) == 2:
                node, scope = self._rod(node, path, scope)
            return self._mapping(node, place, path, scope)
        if isinstance(node, list):
            below = place.child(0, node)
            return [self._node(item, below, (*path, i), scope) for i, item in enumerate(node)]
        if not isinstance(node, str) or node in place.choices():
            return node
        if place.takes_expressions():
            self._use(node)
            return ScopedText(node, scope.values)
        return self._number(node, place, path, scope) if place.takes_numbers() else node

    def _mapping(self, node: dict, place: Place, path: Path, scope: Scope) -> dict:
        if path[-1:] == ("parameters",) and len(path) in (1, 3):  # a rod may have this name, too
            return {key: scope.values.get(key, item) if isinstance(item, str) else item
                    for key, item in node.items()}  # fmt: skip
        return {
            key: self._node(item, place.child(key, node), (*path, key), scope)
            for key, item in node.items()
        }

    def _rod(self, rod: dict, path: Path, outside: Scope) -> tuple[dict, Scope]:
        """Return a rod that says all that its expressions use, and its scope.

        Its parameters replace those of the case or add to them, and what follows from them is
        worked out anew. Those of the case that have another number here become its own.
        """
        own = rod.get("parameters")
        if not isinstance(own, dict) or not own:
            return rod, outside
        case = self.source.data.get("parameters")
        scope = self._parameters(own, (*path, "parameters"), case if isinstance(case, dict) else {})
        follows = {name: value for name, value in scope.values.items()
                   if name not in own and value != outside.values.get(name)}  # fmt: skip
        return {**rod, "parameters": {**own, **follows}}, scope

    def _parameters(self, given: Any, path: Path, outside: dict) -> Scope:
        """Work out parameters, with those of ``outside`` that they do not replace."""
        given = given if isinstance(given, dict) else {}
        scope = work_out({**outside, **given})
        for name, value in given.items():
            if isinstance(value, str):
                self._use(value)
                found = scope.values[name], scope.reasons.get(name)
                self._take((*path, name), *found, value, scope)
        return scope

    def _number(self, text: str, place: Place, path: Path, scope: Scope) -> float | int:
        """Return the number of a text, nan where it has none."""
        value, reason = math.nan, None
        try:
            value = scope.count(text) if place.takes_whole_numbers() else scope.number(text)
        except ExpressionError as error:
            reason = str(error)
        self._use(text)
        self._take(path, value, reason, text, scope)
        return value

    def _use(self, text: str) -> None:
        with suppress(ExpressionError):  # said where it is worked out
            self.used |= names_in(text)

    def _take(self, path: Path, value, reason: str | None, text: str, scope: Scope) -> None:
        """Remember the number at a path, or that there is none."""
        if reason is not None:
            if _WORD.fullmatch(text) and reason.startswith("unknown name"):
                reason = self._no_parameter(path, text.strip(), scope)
            problem = self.source.problem(path, reason)  # of a text, which is in no unit
            self.problems.append(replace(problem, unit=""))
        if reason is not None or math.isnan(value):
            self.failed.add(path)
        else:
            self.source.numbers[path] = value

    def _no_parameter(self, path: Path, word: str, scope: Scope) -> str:
        """Return what is wrong with a bare word in the place of a number."""
        place = self.source.place(path)
        wanted = f"must be {place.noun()}" if place else "must be a number"
        wanted += self.source.problem(path, "").in_unit
        hint = did_you_mean(word, scope.values)
        return f"there is no parameter '{clipped(word)}'{hint or f': {wanted}'}"
