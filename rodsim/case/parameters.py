"""Parameters that are expressions of each other -> their numbers, whatever the order."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from graphlib import CycleError, TopologicalSorter
from typing import Any

from rodsim.case.expressions import ExpressionError, evaluate, names_in
from rodsim.case.words import circle

MOST_CIRCLES = 100  # that are named
WHOLE = 1e-9  # relative; so near a whole number a count is that number: 0.3/0.1 is 3


@dataclass
class Scope:
    """Numbers by name. ``reasons``: what is wrong with some of them, which are nan here.

    A name without a reason that is nan all the same needs another one that is wrong.
    """

    values: dict[str, float] = field(default_factory=dict)
    reasons: dict[str, str] = field(default_factory=dict)

    def number(self, text: str) -> float:
        """Return the number a text stands for; raise ExpressionError where it has none.

        It is nan, and nobody's new mistake, where a parameter in the text has none.
        """
        names = names_in(text)
        known = names <= self.values.keys()
        if known and any(math.isnan(self.values[name]) for name in names):
            return math.nan
        value = evaluate(text, {n: self.values[n] for n in names} if known else self.values)
        if math.isnan(value):
            raise ExpressionError("comes to no number: 0/0, or the root of a negative number?")
        return value

    def count(self, text: str) -> int | float:
        """Return the whole number a text stands for, as ``number`` does."""
        value = self.number(text)
        if math.isnan(value):
            return value
        if math.isinf(value) or abs(value - round(value)) > WHOLE * abs(value):
            raise ExpressionError(f"must be a whole number, and is {value:.9g}")
        return round(value)


def work_out(given: Mapping[str, Any]) -> Scope:
    """Return the numbers of parameters given as numbers or texts.

    What is neither is nan, without a reason: the model refuses it.
    """
    scope = Scope({name: _plain(value) for name, value in given.items()})
    needs = {}
    for name, text in given.items():
        if isinstance(text, str):
            try:
                needs[name] = names_in(text) & given.keys()
            except ExpressionError as error:
                scope.reasons[name] = str(error)
    for name in _order(needs, scope):
        try:
            scope.values[name] = scope.number(given[name])
        except ExpressionError as error:
            scope.reasons[name] = str(error)
    return scope


def _plain(value: Any) -> float:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if is_number else math.nan


def _order(needs: dict[str, frozenset[str]], scope: Scope) -> list[str]:
    """Return the names in an order in which they can be worked out, and note the circles."""
    left = {name: below & needs.keys() for name, below in needs.items()}
    for _ in range(MOST_CIRCLES):
        try:
            return [name for name in TopologicalSorter(left).static_order() if name in left]
        except CycleError as error:
            names = error.args[1][:0:-1]  # each needs the next
        first, scope.reasons[first] = circle(names, list(needs))
        left = {name: below for name, below in left.items() if name not in names}
    return []
