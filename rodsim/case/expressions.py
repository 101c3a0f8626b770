"""Expressions in s, t or other variables and parameters, as in ``-k**2*b*sin(k*s + sigma*t)``.

The text is parsed by Python's own parser, every node is checked against a short whitelist, and what
is left is turned into nested numpy calls. Nothing is ever compiled or executed, so a case file
cannot run code; numbers are float64 from the start, so ``9**9**9**9`` is inf and not a long wait.
"""

from __future__ import annotations

import ast
import keyword
import re
import warnings
from collections.abc import Callable, Mapping
from functools import reduce

import numpy as np

from rodsim.case.words import clipped, did_you_mean, one_of

LONGEST = 1000  # characters
DEEPEST = 100  # a sum of n terms is n deep

_OPERATORS = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: np.power,
    ast.Mod: np.mod,
    ast.UAdd: np.positive,
    ast.USub: np.negative,
    ast.Lt: np.less,
    ast.LtE: np.less_equal,
    ast.Gt: np.greater,
    ast.GtE: np.greater_equal,
}
_ONE_ARGUMENT = {
    name: getattr(np, name) for name in ("sin", "cos", "tan", "exp", "log", "sqrt", "tanh", "abs")
}
_MANY_ARGUMENTS = {"min": np.minimum, "max": np.maximum}
FUNCTIONS = (*_ONE_ARGUMENT, *_MANY_ARGUMENTS, "where")
RESERVED = ("s", "t", "pi", *FUNCTIONS)
NATURAL = ("natural_1", "natural_2", "natural_3")  # the rod's own strain twist, as it is built
VARIABLES = ("s", "t", *NATURAL)

_REFUSED = {
    ast.Attribute: "attribute access (a dot after a name) is not allowed",
    ast.IfExp: "'if ... else' is not allowed: write where(condition, a, b)",
    ast.BoolOp: "'and' and 'or' are not allowed: nest where(condition, a, b)",
    ast.Not: "'not' is not allowed: turn the comparison round",
    ast.Lambda: "lambda is not allowed",
    ast.Tuple: "a comma is only allowed between the arguments of a function",
    ast.FloorDiv: "// is not allowed",
}
_ODD_CHARACTER = re.compile(r"[^A-Za-z0-9_.+\-*/%()<>, ]")
_ODD_CHARACTER_HINTS = {
    "^": "use ** for powers, not ^",
    "=": "'=' is not allowed: the comparisons are < <= > >=",
    "'": "text in quotes is not allowed",
    '"': "text in quotes is not allowed",
}

Function = Callable[..., np.ndarray]  # of the variables, in order
Node = np.float64 | Function  # constants are folded: parameters cost nothing later


class ExpressionError(ValueError):
    """The text is not an expression we accept; the message says why."""


class Expression:
    """A function of s, t and natural_1..3, or other variables, with the parameters bound.

    Calling it as ``expression(s, t)``, the variables in their order, returns a float64 array of the
    shape that they broadcast to; overflow and invalid operations give inf and nan without a
    warning. Raises ExpressionError on construction.
    """

    def __init__(
        self,
        text: str,
        parameters: Mapping[str, float] | None = None,
        variables: tuple[str, ...] = VARIABLES,
    ):
        self.text = " ".join(text.split())
        self.parameters = {name: float(value) for name, value in (parameters or {}).items()}
        self.variables = variables
        builder = _Builder(self.parameters, variables)
        with np.errstate(all="ignore"):
            self._function = builder.build(_parse(self.text), 0)
        self.used = frozenset(builder.used)

    @property
    def uses_s(self) -> bool:
        """Whether it depends on arc length."""
        return "s" in self.used

    @property
    def uses_t(self) -> bool:
        """Whether it depends on time."""
        return "t" in self.used

    @property
    def uses_natural(self) -> bool:
        """Whether it depends on the rod's own strain twist."""
        return not self.used.isdisjoint(NATURAL)

    def __call__(self, *values: np.ndarray | float) -> np.ndarray:
        """Return the values at some values of the variables; those not used may be left out."""
        arrays = [np.asarray(value, dtype=np.float64) for value in values]
        result = np.empty(np.broadcast_shapes(*(array.shape for array in arrays)))
        with np.errstate(all="ignore"):
            result[...] = _value(self._function, *arrays)
        return result

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Expression) and self._identity() == other._identity()

    def __hash__(self) -> int:
        return hash(self._identity())

    def __repr__(self) -> str:
        return f"Expression({self.text!r}, {self.parameters!r})"

    def __reduce__(self):  # closures cannot be pickled; the text can
        return Expression, (self.text, self.parameters, self.variables)

    def _identity(self) -> tuple:
        return self.text, tuple(sorted(self.parameters.items())), self.variables


def reserved_name(name: str) -> str | None:
    """Return why a parameter cannot have this name, or None when it can."""
    if name in RESERVED or name in NATURAL:
        return f"'{name}' already has a meaning in expressions: choose another name"
    if keyword.iskeyword(name):
        return f"'{name}' is a word of the expression language: choose another name"
    return None


def _parse(text: str) -> ast.expr:
    """Return the syntax tree of a text that is short and of harmless characters."""
    if not text:
        raise ExpressionError("the expression is empty")
    if len(text) > LONGEST:
        raise ExpressionError(f"{len(text)} characters long: at most {LONGEST}")
    odd = _ODD_CHARACTER.search(text.replace("<=", "<").replace(">=", ">"))
    if odd is not None:
        default = f"the character {clipped(odd[0])} is not allowed"
        raise ExpressionError(_ODD_CHARACTER_HINTS.get(odd[0], default))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Python's advice on odd code, such as "1if"
            return ast.parse(text, mode="eval").body
    except SyntaxError as error:
        raise ExpressionError(f"not an expression: {error.msg}") from None
    except (ValueError, MemoryError, RecursionError):  # nested too deep for the parser itself
        raise ExpressionError("not an expression: nested too deep") from None


def _value(node: Node, *values: np.ndarray) -> np.ndarray | np.float64:
    return node(*values) if callable(node) else node


def _apply(function: Callable, *nodes: Node) -> Node:
    """Return the function of some nodes as a node, worked out at once if they are constants."""
    if not any(callable(node) for node in nodes):
        return np.float64(function(*nodes))
    return lambda *values: function(*(_value(node, *values) for node in nodes))


def _compared(comparison: Callable) -> Callable:
    """Return a comparison as 1.0 or 0.0, so that arithmetic on it means the same everywhere."""
    return lambda a, b: np.where(comparison(a, b), 1.0, 0.0)


def _chosen(condition, if_true, if_false):
    return np.where(condition != 0.0, if_true, if_false)


class _Builder:
    """Turns a syntax tree into nodes, refusing all that is not on the whitelist."""

    def __init__(self, parameters: Mapping[str, float], variables: tuple[str, ...]):
        self.parameters = parameters
        self.variables = variables
        self.used: set[str] = set()

    def build(self, tree: ast.expr, depth: int) -> Node:
        """Return the node of a syntax tree; raise ExpressionError for what is not allowed."""
        if depth > DEEPEST:
            raise ExpressionError(f"nested deeper than {DEEPEST} levels")
        kind = type(tree)
        if kind is ast.Constant:
            return self._number(tree.value)
        if kind is ast.Name:
            return self._name(tree.id)
        if kind is ast.UnaryOp:
            return _apply(self._operator(tree.op), self.build(tree.operand, depth + 1))
        if kind is ast.BinOp:
            sides = (self.build(side, depth + 1) for side in (tree.left, tree.right))
            return _apply(self._operator(tree.op), *sides)
        if kind is ast.Compare:
            return self._comparison(tree, depth)
        if kind is ast.Call:
            return self._call(tree, depth)
        raise ExpressionError(_REFUSED.get(kind, f"{kind.__name__} is not allowed"))

    def _number(self, value: object) -> Node:
        if type(value) not in (int, float):
            raise ExpressionError(f"{clipped(repr(value))} is not a number")
        try:
            return np.float64(value)
        except OverflowError:
            raise ExpressionError("a number is too large") from None

    def _name(self, name: str) -> Node:
        if name in self.variables:
            self.used.add(name)
            place = self.variables.index(name)
            return lambda *values: values[place]
        if name == "pi":
            return np.float64(np.pi)
        if name in self.parameters:
            return np.float64(self.parameters[name])
        if name in FUNCTIONS:
            raise ExpressionError(f"'{name}' is a function: write {name}(...)")
        variables = [name for name in self.variables if name not in NATURAL]
        known = [*variables, "pi", *self.parameters]
        hint = did_you_mean(name, (*known, *FUNCTIONS))
        known = f": it can use {one_of(known)}"
        raise ExpressionError(f"unknown name '{clipped(name)}'{hint or known}")

    def _operator(self, operator: ast.AST) -> Callable:
        kind = type(operator)
        if kind not in _OPERATORS:
            raise ExpressionError(
                _REFUSED.get(kind, f"the operator {kind.__name__} is not allowed")
            )
        return _OPERATORS[kind]

    def _comparison(self, tree: ast.Compare, depth: int) -> Node:
        """Return a < b <= c as the product of its parts."""
        sides = [self.build(side, depth + 1) for side in (tree.left, *tree.comparators)]
        parts = [
            _apply(_compared(self._operator(operator)), left, right)
            for operator, left, right in zip(tree.ops, sides[:-1], sides[1:], strict=True)
        ]
        return reduce(lambda a, b: _apply(np.multiply, a, b), parts)

    def _call(self, tree: ast.Call, depth: int) -> Node:
        if not isinstance(tree.func, ast.Name):
            raise ExpressionError("a name must stand before '(': did you leave out a '*'?")
        name = tree.func.id
        if name not in FUNCTIONS:
            hint = did_you_mean(name, FUNCTIONS) or f": the functions are {', '.join(FUNCTIONS)}"
            raise ExpressionError(f"unknown function '{clipped(name)}'{hint}")
        if tree.keywords or any(isinstance(argument, ast.Starred) for argument in tree.args):
            raise ExpressionError(f"{name} takes plain arguments only")
        _check_count(name, len(tree.args))
        arguments = [self.build(argument, depth + 1) for argument in tree.args]
        if name == "where":
            return _apply(_chosen, *arguments)
        if name in _ONE_ARGUMENT:
            return _apply(_ONE_ARGUMENT[name], *arguments)
        return reduce(lambda a, b: _apply(_MANY_ARGUMENTS[name], a, b), arguments)


def _check_count(name: str, count: int) -> None:
    if name in _MANY_ARGUMENTS and count < 2:
        raise ExpressionError(f"{name} takes two or more arguments, not {count}")
    wanted = {"where": 3}.get(name, 1)
    if name not in _MANY_ARGUMENTS and count != wanted:
        raise ExpressionError(f"{name} takes {wanted} argument{'s' * (wanted > 1)}, not {count}")
