"""Derivatives of expressions, against finite differences of 40 digits by mpmath."""

import pickle

import numpy as np
import pytest
from mpmath import mp, mpf

from rodsim.case import Expression
from rodsim.case.derivatives import RULES, STEPS
from rodsim.case.functions import FUNCTIONS, OPERATIONS

P = {"a": 0.7, "k": 1.3}
POINTS = ((0.31, -0.83), (0.57, 0.42), (-0.46, 0.29))  # x, y
NAMES = {
    **{name: getattr(mp, name) for name in ("sin", "cos", "tan", "exp", "log", "sqrt", "tanh",
                                            "sinh", "cosh", "sign", "floor", "pi")},
    "arcsin": mp.asin, "arccos": mp.acos, "arctan": mp.atan, "arctan2": mp.atan2,
    "abs": abs, "min": min, "max": max, "where": lambda c, a, b: a if c else b,
    "heaviside": lambda x, at_0=0.5: at_0 if x == 0 else mpf(x > 0), **P,
}  # fmt: skip
TEXTS = [
    "sin(k*x + a*y)", "cos(x*x - y)", "tan(x*y)", "exp(-k*x*y)", "log(3 + x - y)",
    "sqrt(2 + x*y)", "tanh(x - 2*y)", "sinh(x*y)", "cosh(2*x - y)", "arcsin(x*y)",
    "arccos(x - y/2)", "arctan(k*x/y)", "arctan2(x, y)", "arctan2(-x*y, x - 1)",
    "abs(x)*y", "abs(x - y)**3", "min(x, y, x*y)", "max(x*x, y, 0.2)", "where(x < y, x*y, y/x)",
    "where(0 < x <= 0.4, x**3, sin(y))", "sign(x)*x*y", "floor(3*x)*y + x", "heaviside(y)*x*x",
    "(7*x) % 2", "2 % (x + 2)", "(x*9) % (y + 1)", "x**2", "x**3/y**2", "(x + 2)**y", "k**(x*y)",
    "(x + 2)**(-k)", "x**0 + y**1", "-x + +y - 4", "(x < 1)*x + (x >= y)*y", "1/(x - 3) - x/y",
    "exp(sin(k*x)*cos(y))*tanh(x)/(1 + x**2 + y**2)",
]  # fmt: skip


def sides(text, by, x, y):
    """Return the derivative by mpmath's central differences, at 40 digits."""
    with mp.workdps(40):
        # constants of the text are the float64 that the expression has
        code = compile(text, text, "eval")

        def value(moved):
            at = {"x": mpf(x), "y": mpf(y), by: moved}
            return mpf(eval(code, {"__builtins__": {}}, {**NAMES, **at}))

        return float(mp.diff(value, mpf({"x": x, "y": y}[by])))


@pytest.mark.parametrize("by", ["x", "y"])
@pytest.mark.parametrize("text", TEXTS)
def test_derivative_is_the_limit_of_differences(text, by):
    slope = Expression(text, P, ("x", "y")).derivative(by)
    for x, y in POINTS:
        expected = sides(text, by, x, y)
        # float64 rounding of the formula; 0.7 of the text is 3e-17 off that of mpmath
        assert slope(x, y) == pytest.approx(expected, rel=1e-13, abs=1e-14), (text, by, x, y)


@pytest.mark.parametrize("text", ["sin(k*x)*exp(y*x)", "x**3*tanh(y)", "(x + 2)**y", "1/(x - 3)"])
def test_second_derivatives(text):
    twice = Expression(text, P, ("x", "y")).derivative("x").derivative("x")
    step = 2.0**-12
    first = Expression(text, P, ("x", "y")).derivative("x")
    for x, y in POINTS:
        differences = (first(x + step, y) - first(x - step, y)) / (2 * step)
        assert twice(x, y) == pytest.approx(differences, rel=1e-5)  # step^2/6 of the fourth


def test_every_function_and_operation_has_a_rule_and_is_tried():
    assert set(OPERATIONS) - STEPS <= set(RULES)
    assert all(any(f"{name}(" in text for text in TEXTS) for name in FUNCTIONS)


@pytest.mark.parametrize(
    ("text", "x", "slope"),
    [
        ("abs(x)", 0.0, 1.0),
        ("min(x, 3*x)", 0.0, 1.0),
        ("max(2*x, 3*x)", 0.0, 2.0),
        ("where(x < 0, 5*x, 6*x)", 0.0, 6.0),
        ("sign(x) + floor(x) + heaviside(x) + (x > 0)", 0.0, 0.0),
        ("x**2", 0.0, 0.0),
        ("x**1", 0.0, 1.0),
        ("x**0", 0.0, 0.0),
        ("x**(2 + 0*x)", 0.0, 0.0),  # 0**2 log 0 is 0, not nan
        ("(0*x)**(2 + x)", 0.3, 0.0),
        ("tanh(x)", 800.0, 0.0),
        ("where(x > 0, x*log(x), 0)", 0.0, 0.0),  # the other branch is nan there
    ],
)
def test_at_kinks_and_ends_it_is_the_slope_of_one_side(text, x, slope):
    assert Expression(text, {}, ("x",)).derivative("x")(x) == slope


def test_what_does_not_depend_on_it_has_slope_zero_exactly():
    slope = Expression("exp(1000*y)*k", P, ("x", "y")).derivative("x")
    assert slope(2.0, 2.0) == 0.0
    assert slope.uses == frozenset()


def test_derivative_is_an_expression():
    first = Expression("x*sin(y)", {}, ("x", "y"))
    slope = first.derivative("y")
    assert slope.uses == {"x", "y"}
    assert slope(np.array([2.0, 3.0]), np.zeros((4, 1))).shape == (4, 2)
    assert slope != first
    assert slope == Expression("x*sin(y)", {}, ("x", "y")).derivative("y")
    assert pickle.loads(pickle.dumps(slope))(2.0, 0.0) == 2.0
    assert first(2.0, 0.0) == 0.0  # as it was
    with pytest.raises(ValueError, match="'t' is none of the variables x or y"):
        first.derivative("t")


def test_a_long_sum_has_a_derivative():
    text = "+".join(f"sin({n}*x)" for n in range(1, 1400))
    slope = Expression(text, {}, ("x",)).derivative("x")
    n = np.arange(1, 1400)
    assert slope(0.3) == pytest.approx((n * np.cos(0.3 * n)).sum(), abs=1e-8)
