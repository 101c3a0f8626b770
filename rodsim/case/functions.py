"""The functions of expressions, and what to write for those of other languages."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rodsim.case.words import did_you_mean

LIBRARIES = ("np", "numpy", "math", "jnp")  # what people write before a function


def _chosen(condition, if_true, if_false):
    return np.where(condition != 0.0, if_true, if_false)


def _half_at_zero(x):
    return np.heaviside(x, 0.5)  # the mean of both sides


_NUMPY = (
    *("sin", "cos", "tan", "arcsin", "arccos", "arctan", "sinh", "cosh", "tanh"),
    *("exp", "log", "sqrt", "abs", "sign", "floor"),
)
FUNCTIONS: dict[str, tuple[Callable, int]] = {  # with the number of arguments
    **{name: (getattr(np, name), 1) for name in _NUMPY},
    "heaviside": (_half_at_zero, 1),
    "arctan2": (np.arctan2, 2),
    "where": (_chosen, 3),
}
OF_MANY = {"min": np.minimum, "max": np.maximum}  # of two arguments or more
NAMES = (*FUNCTIONS, *OF_MANY)


def wrong_count(name: str, count: int) -> str:
    """Return why a function cannot take so many arguments, empty if it can."""
    if name in OF_MANY:
        return "" if count > 1 else f"{name} takes two or more arguments, not {count}"
    wanted = FUNCTIONS[name][1]
    if count == wanted:
        return ""
    return f"{name} takes {wanted} argument{'s' * (wanted > 1)}, not {count}"


def library_hint(library: str, name: str, known: tuple[str, ...]) -> str:
    """Return what to write for ``np.sin``; empty for a dot that has nothing to do with NumPy."""
    if library not in LIBRARIES:
        return ""
    if name in known:
        shown = f"{name}(...)" if name in NAMES else name
        return f"write {shown}, without '{library}.'"
    return f"there is no '{library}' here{did_you_mean(name, known)}"
