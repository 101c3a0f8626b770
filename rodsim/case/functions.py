"""What expressions are made of: every operation, how it is computed, how many arguments."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rodsim.case.words import did_you_mean


@dataclass(frozen=True)
class Function:
    """A function as users write it: its operation, and how many arguments it takes at least."""

    operation: str
    fewest: int = 1
    most: int | None = 1  # None: any number, taken two at a time from the left


def _compared(comparison: Callable) -> Callable:
    """Return a comparison as 1.0 or 0.0, so that arithmetic on it means the same everywhere."""
    return lambda a, b: np.where(comparison(a, b), 1.0, 0.0)


def _chosen(condition, if_true, if_false):
    return np.where(condition != 0.0, if_true, if_false)


_ONE_ARGUMENT = (
    "sin", "cos", "tan", "exp", "log", "sqrt", "tanh", "abs",
    "arcsin", "arccos", "arctan", "sinh", "cosh", "sign", "floor",
)  # fmt: skip
COMPARISONS = {"<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal}
OPERATIONS: dict[str, Callable] = {  # each takes and returns float64, arrays of any shape
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "**": np.power,
    "%": np.mod,
    "pos": np.positive,
    "neg": np.negative,
    "floor_divide": np.floor_divide,
    "min": np.minimum,
    "max": np.maximum,
    "arctan2": np.arctan2,
    "heaviside": np.heaviside,
    "where": _chosen,
    **{name: getattr(np, name) for name in _ONE_ARGUMENT},
    **{sign: _compared(comparison) for sign, comparison in COMPARISONS.items()},
    "==": _compared(np.equal),
}
FUNCTIONS: dict[str, Function] = {
    **{name: Function(name) for name in _ONE_ARGUMENT},
    "arctan2": Function("arctan2", 2, 2),
    "heaviside": Function("heaviside", 1, 2),  # the value at 0 is 1/2, or the second argument
    "min": Function("min", 2, None),
    "max": Function("max", 2, None),
    "where": Function("where", 3, 3),
}
_LIBRARY = re.compile(r"\b(np|numpy|math|jnp)\.([A-Za-z_]\w*)")  # as people write it elsewhere


def library_hint(text: str) -> str:
    """Return what to write for the first ``np.sin`` in a text; empty where there is none."""
    if not (found := _LIBRARY.search(text)):
        return ""
    library, name = found.groups()
    if name in FUNCTIONS or name == "pi":
        call = "(...)" if name in FUNCTIONS else ""
        return f"write {name}{call}, without '{library}.'"
    return f"there is no '{library}' here{did_you_mean(name, (*FUNCTIONS, 'pi'))}"
