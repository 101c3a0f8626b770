"""Expressions in variables such as s and t and the parameters: ``-k**2*b*sin(k*s + sigma*t)``.

The text is read by a grammar of its own (``grammar.py``) into a list of operations (``graph.py``)
that NumPy computes. Nothing is ever compiled or executed, so a case file cannot run code; numbers
are float64 from the start, so ``9**9**9**9`` is inf and not a long wait.
"""

from __future__ import annotations

import keyword
from collections.abc import Iterable, Mapping
from functools import reduce

import numpy as np

from rodsim.case.derivatives import differentiate
from rodsim.case.functions import FUNCTIONS
from rodsim.case.grammar import ExpressionError, parse
from rodsim.case.graph import Graph, Program, bound
from rodsim.case.words import clipped, did_you_mean, one_of

__all__ = ["FUNCTIONS", "RESERVED", "Expression", "ExpressionError", "evaluate", "names_in"]

CONSTANTS = {"pi": np.pi}
NATURAL = ("natural_1", "natural_2", "natural_3")  # the rod's own strain twist, as it is built
RESERVED = (
    "s", "t", "pi", "sin", "cos", "tan", "exp", "log", "sqrt", "tanh", "abs", "min", "max", "where",
)  # fmt: skip  # later functions are told from parameters by their bracket


class Expression:
    """A function of some variables, arc length s and time t by default, parameters bound to values.

    Calling it with one array for each variable, ``expression(s, t)``, returns a float64 array of
    the shape that these broadcast to; overflow and invalid operations give inf and nan without a
    warning. Raises ExpressionError on construction.

    Attributes
    ----------
    text : on one line. parameters : name -> value. variables : names, in the order of the call.
    uses : those of the variables that the value depends on.
    """

    def __init__(
        self,
        text: str,
        parameters: Mapping[str, float] | None = None,
        variables: Iterable[str] = ("s", "t"),
    ):
        self.text = _on_one_line(text)
        self.parameters = {name: float(value) for name, value in (parameters or {}).items()}
        self.variables = tuple(variables)
        self._by: tuple[str, ...] = ()  # the variables it is differentiated by
        nodes = parse(self.text)
        _check_names(nodes, self.parameters, self.variables)
        self._take(*bound(nodes, CONSTANTS | self.parameters))

    def _take(self, graph, root) -> None:
        self._graph, self._root = graph, root
        self._program = Program(graph, root)
        self.uses = frozenset(name for _, name in self._program.names)

    def __call__(self, *values: np.ndarray | float) -> np.ndarray:
        """Return the values at arrays of the variables, in the order of ``variables``.

        The last ones may be left out where they are not used.
        """
        arrays = [np.asarray(value, dtype=np.float64) for value in values]
        result = np.empty(np.broadcast_shapes(*(array.shape for array in arrays)))
        result[...] = self._program(dict(zip(self.variables, arrays, strict=False)))
        return result

    def derivative(self, variable: str) -> Expression:
        """Return the exact derivative by one of the variables, a function of the same variables.

        At the kinks of abs, min, max and where it is the slope of one side; sign, floor, heaviside
        and comparisons have slope 0. It can be differentiated again.
        """
        if variable not in self.variables:
            raise ValueError(f"'{variable}' is none of the variables {one_of(self.variables)}")
        slope = Expression.__new__(Expression)
        slope.text, slope.parameters, slope.variables = self.text, self.parameters, self.variables
        slope._by = (*self._by, variable)
        slope._take(*differentiate(self._graph, self._root, variable))
        return slope

    def add_to(self, graph: Graph) -> int:
        """Add what it computes to a graph, return its node there."""
        return graph.absorb(self._graph, self._root)

    @property
    def constant(self) -> float | None:
        """The number it is, where it depends on none of its variables."""
        return None if self.uses else float(self._graph.value(self._root))

    @property
    def uses_s(self) -> bool:
        """Whether it depends on the arc length."""
        return "s" in self.uses

    @property
    def uses_t(self) -> bool:
        """Whether it depends on time."""
        return "t" in self.uses

    @property
    def uses_natural(self) -> bool:
        """Whether it depends on the rod's own strain twist."""
        return not self.uses.isdisjoint(NATURAL)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Expression) and self._identity() == other._identity()

    def __hash__(self) -> int:
        return hash(self._identity())

    def __repr__(self) -> str:
        by = "".join(f".derivative({name!r})" for name in self._by)
        return f"Expression({self.text!r}, {self.parameters!r}, {self.variables!r}){by}"

    def __reduce__(self):
        return _again, (self.text, self.parameters, self.variables, self._by)

    def _identity(self) -> tuple:
        return self.text, tuple(sorted(self.parameters.items())), self.variables, self._by


def _again(text, parameters, variables, by) -> Expression:
    """Return the expression that was pickled."""
    return reduce(Expression.derivative, by, Expression(text, parameters, variables))


def evaluate(text: str, parameters: Mapping[str, float]) -> float:
    """Return the number that an expression of the parameters alone stands for."""
    return float(Expression(text, parameters, ())())


def names_in(text: str) -> frozenset[str]:
    """Return the parameters and variables a text names; raise ExpressionError for no formula."""
    return frozenset(node.name for node in parse(_on_one_line(text)) if node.name) - {*CONSTANTS}


def reserved_name(name: str) -> str | None:
    """Return why a parameter cannot have this name, or None when it can."""
    if name in RESERVED or name in NATURAL:
        return f"'{name}' already has a meaning in expressions: choose another name"
    if keyword.iskeyword(name):
        return f"'{name}' is a word of the expression language: choose another name"
    return None


def _on_one_line(text: str) -> str:
    return " ".join(text.split())


def _check_names(nodes, parameters, variables) -> None:
    """Raise ExpressionError for the first name that means nothing here, or two things."""
    names = [node.name for node in nodes if node.name]
    for name in names:
        if name in variables and name in parameters and name not in RESERVED:
            reason = "is the variable of this expression and a parameter: rename the parameter"
            raise ExpressionError(f"'{name}' {reason}")
        if name in variables or name in parameters or name in CONSTANTS:
            continue
        if name in FUNCTIONS:
            raise ExpressionError(f"'{name}' is a function: write {name}(...)")
        known = [*(v for v in variables if v not in NATURAL), *CONSTANTS, *parameters]
        hint = did_you_mean(name, (*known, *FUNCTIONS)) or f": it can use {one_of(known)}"
        raise ExpressionError(f"unknown name '{clipped(name)}'{hint}")
