"""Exact derivatives of formulas: the chain rule, operation by operation, in one pass.

Where a function has a kink (abs, min, max, where) the value is the slope of one side. Steps (sign,
floor, heaviside, comparisons) have slope 0 everywhere, also at the step.
"""

from __future__ import annotations

from collections.abc import Callable

from rodsim.case.graph import Graph, needed

Rule = Callable[..., int]  # (calculus, node, arguments, their slopes) -> slope


class _Calculus:
    """Arithmetic on nodes that leaves out what is 0 or 1 times something."""

    def __init__(self, graph: Graph):
        self.graph, self.apply = graph, graph.apply
        self.zero, self.one = graph.constant(0.0), graph.constant(1.0)

    def number(self, value: float) -> int:
        return self.graph.constant(value)

    def add(self, a: int, b: int) -> int:
        if self.zero in (a, b):
            return b if a == self.zero else a
        return self.apply("+", a, b)

    def minus(self, a: int) -> int:
        return a if a == self.zero else self.apply("neg", a)

    def times(self, a: int, b: int) -> int:
        if self.zero in (a, b):
            return self.zero
        if self.one in (a, b):
            return b if a == self.one else a
        return self.apply("*", a, b)

    def over(self, a: int, b: int) -> int:
        return a if a == self.zero or b == self.one else self.apply("/", a, b)

    def square(self, a: int) -> int:
        return self.apply("*", a, a)

    def choose(self, condition: int, a: int, b: int) -> int:
        return a if a == b else self.apply("where", condition, a, b)


def differentiate(graph: Graph, root: int, variable: str) -> tuple[Graph, int]:
    """Return a graph and its node for d root / d variable; the given graph stays as it is."""
    graph = graph.copy()
    calculus, slopes = _Calculus(graph), {}
    for index in needed(graph.nodes, root):
        node = graph.nodes[index]
        below = [slopes[argument] for argument in node.arguments]
        if node.name == variable:
            slopes[index] = calculus.one
        elif all(slope == calculus.zero for slope in below) or node.operation in STEPS:
            slopes[index] = calculus.zero
        else:
            slopes[index] = RULES[node.operation](calculus, index, node.arguments, below)
    return graph, slopes[root]


def _of_one(slope: Rule) -> Rule:
    """Return the rule of a function of one argument from its slope there."""
    return lambda c, y, x, dx: c.times(slope(c, y, x[0]), dx[0])


def _divided(denominator: Rule) -> Rule:
    """Return the rule of a function of one argument whose slope is 1/denominator."""
    return lambda c, y, x, dx: c.over(dx[0], denominator(c, y, x[0]))


def _product(c, y, x, dx):
    return c.add(c.times(dx[0], x[1]), c.times(x[0], dx[1]))


def _quotient(c, y, x, dx):
    """Return (a' - (a/b) b')/b."""
    return c.over(c.add(dx[0], c.minus(c.times(y, dx[1]))), x[1])


def _power(c, y, x, dx):
    """Return b a^(b-1) a' + a^b log(a) b'; a factor that is 0 wins over one that is infinite."""
    a, b = x
    exponent = c.graph.value(b)
    slope = c.times(b, c.apply("**", a, c.add(b, c.number(-1.0))))
    if exponent is None:
        slope = c.choose(c.apply("==", b, c.zero), c.zero, slope)
    elif exponent == 2.0:
        slope = c.times(b, a)
    growth = c.zero
    if dx[1] != c.zero:
        growth = c.choose(c.apply("==", y, c.zero), c.zero, c.times(y, c.apply("log", a)))
    return c.add(c.times(slope, dx[0]), c.times(growth, dx[1]))


def _modulo(c, y, x, dx):
    """a % b = a - floor(a/b) b."""
    whole = c.apply("floor_divide", *x)
    return c.add(dx[0], c.minus(c.times(whole, dx[1])))


def _angle(c, y, x, dx):
    """Return (b a' - a b')/(a^2 + b^2), of the angle whose tangent is a/b."""
    above = c.add(c.times(x[1], dx[0]), c.minus(c.times(x[0], dx[1])))
    return c.over(above, c.apply("+", c.square(x[0]), c.square(x[1])))


def _circle(c, y, x):
    """Return sqrt(1 - x^2), also near 1."""
    sides = c.apply("-", c.one, x), c.apply("+", c.one, x)
    return c.apply("sqrt", c.apply("*", *sides))


STEPS = {"sign", "floor", "heaviside", "floor_divide", "<", "<=", ">", ">=", "=="}
RULES: dict[str, Rule] = {
    "+": lambda c, y, x, dx: c.add(*dx),
    "-": lambda c, y, x, dx: c.add(dx[0], c.minus(dx[1])),
    "*": _product,
    "/": _quotient,
    "**": _power,
    "%": _modulo,
    "pos": lambda c, y, x, dx: dx[0],
    "neg": lambda c, y, x, dx: c.minus(dx[0]),
    "sin": _of_one(lambda c, y, x: c.apply("cos", x)),
    "cos": _of_one(lambda c, y, x: c.minus(c.apply("sin", x))),
    "tan": _divided(lambda c, y, x: c.square(c.apply("cos", x))),
    "exp": _of_one(lambda c, y, x: y),
    "log": _divided(lambda c, y, x: x),
    "sqrt": _divided(lambda c, y, x: c.apply("*", c.number(2.0), y)),
    "sinh": _of_one(lambda c, y, x: c.apply("cosh", x)),
    "cosh": _of_one(lambda c, y, x: c.apply("sinh", x)),
    "tanh": _divided(lambda c, y, x: c.square(c.apply("cosh", x))),
    "arcsin": _divided(lambda c, y, x: _circle(c, y, x)),
    "arccos": _divided(lambda c, y, x: c.minus(_circle(c, y, x))),
    "arctan": _divided(lambda c, y, x: c.apply("+", c.one, c.square(x))),
    "arctan2": _angle,
    "abs": lambda c, y, x, dx: c.choose(c.apply(">=", x[0], c.zero), dx[0], c.minus(dx[0])),
    "min": lambda c, y, x, dx: c.choose(c.apply("<=", *x), *dx),
    "max": lambda c, y, x, dx: c.choose(c.apply(">=", *x), *dx),
    "where": lambda c, y, x, dx: c.choose(x[0], *dx[1:]),
}
