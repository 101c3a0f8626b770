"""Expressions: the right values, and nothing but arithmetic."""

import math
import pickle
import random
import re

import numpy as np
import pytest

from rodsim.case import Expression, ExpressionError
from rodsim.case.expressions import evaluate, names_in

S = np.array([0.0, 0.3, 1.7])
T = 0.4
P = {"k": 1.25, "b": 0.6, "sigma": 40.0}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("-k**2*b*sin(k*s + sigma*t)", lambda s: -(1.25**2) * 0.6 * math.sin(1.25 * s + 16.0)),
        ("2**-1**2", lambda s: 0.5),
        ("-s**2", lambda s: -(s**2)),
        ("7 % 3 - s/2", lambda s: 1.0 - s / 2),
        ("2*pi*t", lambda s: 0.8 * math.pi),
        ("min(s, 1, t)", lambda s: min(s, 0.4)),
        ("max(s, 1)", lambda s: max(s, 1.0)),
        ("where(s < 1, s, -s)", lambda s: s if s < 1 else -s),
        ("where(0 < s <= 0.3, 1, 2)", lambda s: 1.0 if 0 < s <= 0.3 else 2.0),
        ("-(s >= 1)", lambda s: -1.0 if s >= 1 else 0.0),
        ("(s > 0) + (s > 1)", lambda s: float(s > 0) + float(s > 1)),
        ("exp(s) + log(s + 1) + sqrt(s)", lambda s: math.exp(s) + math.log(s + 1) + math.sqrt(s)),
        ("tanh(s)*tan(s) + cos(s) + abs(-s)",
         lambda s: math.tanh(s) * math.tan(s) + math.cos(s) + s),
        ("1\n+ s", lambda s: 1 + s),
        ("sin (s) - -+-s", lambda s: math.sin(s) - s),
        ("2**3**s*2 - 8/2/2", lambda s: 2 * 2 ** (3**s) - 2),
        ("s - 1 - t < s*t + 1 <= 3", lambda s: float(s - 1.4 < 0.4 * s + 1 <= 3)),
        ("(s < t) < 1", lambda s: float(float(s < 0.4) < 1)),
        ("0x10 + 1_0 + .5 + 2. + 1e-1*s", lambda s: 28.5 + 0.1 * s),
        ("arcsin(s/2) + arccos(s/3) + arctan(s) + arctan2(s, -t)",
         lambda s: math.asin(s / 2) + math.acos(s / 3) + math.atan(s) + math.atan2(s, -0.4)),
        ("sinh(s) - cosh(s) + floor(-s) + 3*sign(s - 0.3)",
         lambda s: -math.exp(-s) + math.floor(-s) + 3 * np.sign(s - 0.3)),
        ("heaviside(s - 0.3) + heaviside(s - 0.3, 7)",
         lambda s: {0.0: 0, 0.3: 7.5, 1.7: 2}[float(s)]),
    ],
)  # fmt: skip
def test_value(text, value):
    found = Expression(text, P)(S, T)
    assert found.dtype == np.float64
    assert found == pytest.approx([value(s) for s in S], rel=1e-14, abs=1e-15)


def test_result_has_the_shape_of_s():
    assert Expression("3")(np.zeros((2, 5)), 0.0).shape == (2, 5)


def test_result_is_a_copy():
    s = S.copy()
    Expression("s")(s, 0.0)[:] = 9.0
    assert s.tolist() == S.tolist()


@pytest.mark.parametrize(
    ("text", "uses_s", "uses_t"),
    [("k", False, False), ("s", True, False), ("t", False, True), ("where(t<1, s, 2)", True, True)],
)
def test_what_it_depends_on(text, uses_s, uses_t):
    expression = Expression(text, P)
    assert (expression.uses_s, expression.uses_t) == (uses_s, uses_t)


@pytest.mark.parametrize("text", ["9**9**9**9", "1/0", "1e999", "exp(1000)"])
def test_overflow_is_infinite_without_a_warning(text):
    assert np.isinf(Expression(text)(S, 0.0)).all()


def test_invalid_is_nan_without_a_warning():
    assert np.isnan(Expression("sqrt(-1 - s) + log(-1)")(S, 0.0)).all()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("k*sgima", "unknown name 'sgima': did you mean 'sigma'?"),
        ("x", "unknown name 'x': it can use s, t, pi, k, b or sigma"),
        ("sinn(s)", "unknown function 'sinn': did you mean 'sin'?"),
        ("k(s)", "unknown function 'k'"),
        ("sin", "'sin' is a function"),
        ("atan(s)", "did you mean 'arctan'?"),
        ("asin(s)", "did you mean 'arcsin'?"),  # and not 'sin', which is nearer by letters
        ("atan2(s, t)", "did you mean 'arctan2'?"),
        ("ln(s)", "did you mean 'log'?"),
        ("np.sin(t)", "write sin(...), without 'np.'"),
        ("2*numpy.pi*t", "write pi, without 'numpy.'"),
        ("math.atan(t)", "there is no 'math' here: did you mean 'arctan'?"),
        ("arctan2(s)", "arctan2 takes 2 arguments, not 1"),
        ("0,5*s", "decimals have a point"),
        ("2(s + 1)", "did you leave out a '*'"),
        ("2 s", "not an expression"),
        ("", "empty"),
        ("1 +", "not an expression"),
        ("s^2", "use ** for powers"),
        ("s == 1", "the comparisons are"),
        ("1 if s else 2", "where(condition, a, b)"),
        ("s and t", "where(condition, a, b)"),
        ("not s", "turn the comparison round"),
        ("s // 2", "// is not allowed"),
        ("s in t", "not allowed"),
        ("s << 2", "not allowed"),
        ("sin(s, t)", "sin takes 1 argument, not 2"),
        ("min(s)", "two or more"),
        ("where(s, 1)", "where takes 3 arguments, not 2"),
        ("max(*s)", "plain arguments"),
        ("sin(x=1)", "not allowed"),
        ("1j", "not a number"),
        ("True", "not a number"),
        ("None", "not a number"),
        ("1, 2", "a comma"),
        ("s.real", "attribute access"),
        ("k.__class__.__mro__", "attribute access"),
        ("__import__(os)", "unknown function"),
        ("open(s)", "unknown function"),
        ("lambda: 1", "not allowed"),
        ("(s := 1)", "not allowed"),
        ("[s for s in t]", "not allowed"),
        ("{}", "not allowed"),
        ("'a'*10", "text in quotes"),
        ("s[0]", "not allowed"),
        ("f'{s}'", "text in quotes"),
        ("(yield)", "not allowed"),
        ("await s", "not allowed"),
        ("s; t", "not allowed"),
        ("ｓ", "not allowed"),
        ("9" * 900, "too large"),
        ("-" * 900 + "1", "nested"),
        ("(" * 400 + "1" + ")" * 400, "nested deeper than 100"),
        ("2**" * 400 + "s", "nested deeper than 100"),
        ("sin(" * 400 + "s", "nested deeper than 100"),
        ("(" * 1_000_000, "at most 20000"),
        ("+".join(["s"] * 10_001), "20001 characters long"),
        ("0x" + "f" * 900, "too large"),
        ("0x", "not a number"),
        ("2s", "'*'"),
        ("(s + 1", "a '(' is not closed"),
        ("s + 1)", "a ')' without its '('"),
        ("(1, 2)", "a comma"),
        ("min(1, )", "something is missing before a ')'"),
        ("min(, 1)", "nothing stands before a comma"),
        ("* s", "nothing stands before '*'"),
        ("sin()", "sin takes 1 argument, not 0"),
        ("()", "something is missing"),
        ("heaviside(s, t, 1)", "heaviside takes 1 or 2 arguments, not 3"),
    ],
)
def test_refused(text, words):
    with pytest.raises(ExpressionError) as caught:
        Expression(text, P)
    assert words in str(caught.value)


@pytest.mark.parametrize(("sign", "value"), [("+", 10_000 * S), ("-", -9_998 * S)])
def test_a_chain_may_be_as_long_as_a_text(sign, value):
    assert Expression(sign.join(["s"] * 10_000))(S, 0.0) == pytest.approx(value, rel=1e-10)
    assert Expression("*".join(["(1 + s/9)"] * 2_000))(1e-3, 0.0) == pytest.approx(
        (1 + 1e-3 / 9) ** 2_000, rel=1e-11
    )


def test_a_fourier_sum_is_what_numpy_makes_of_it():
    """A measured wave of curvature as people bring it: 60 terms, 2 700 characters, in one text."""
    rng = np.random.default_rng(3)
    a, k, sigma = rng.normal(size=60), rng.uniform(0.1, 9, 60), rng.uniform(1, 90, 60)
    terms = zip(a.round(9), k.round(9), sigma.round(6), strict=True)
    text = " + ".join(f"{x}*sin({y}*s + {z}*t)" for x, y, z in terms)
    assert 2_000 < len(text) < 20_000
    s, t = np.linspace(0, 4, 7), np.array([[0.0], [0.13]])
    phases = k.round(9) * s[:, None] + sigma.round(6) * t[..., None]
    expected = (a.round(9) * np.sin(phases)).sum(axis=-1)
    assert Expression(text)(s, t) == pytest.approx(expected, abs=1e-12)


def test_a_name_of_a_function_may_be_that_of_a_parameter():
    """Functions that came later take no name away from the files there are."""
    assert Expression("floor*floor(floor)", {"floor": 2.5})(0.0, 0.0) == 5.0


def test_other_variables():
    flow = Expression("gamma*z - x*t", {"gamma": 3.5}, ("x", "y", "z", "t"))
    assert flow(2.0, 9.0, np.array([1.0, 2.0]), 0.5).tolist() == [2.5, 6.0]
    assert flow.uses == {"x", "z", "t"}
    assert flow != Expression("gamma*z - x*t", {"gamma": 3.5}, ("x", "z", "y", "t"))
    with pytest.raises(ExpressionError, match="unknown name 's': it can use x, y, z, t, pi or"):
        Expression("s", {"gamma": 3.5}, ("x", "y", "z", "t"))
    with pytest.raises(ExpressionError, match="'x' is the variable of this expression and a para"):
        Expression("x", {"x": 3.5}, ("x", "y"))
    assert Expression("x*s", {"x": 3.5})(2.0, 0.0) == 7.0


def test_numbers_of_parameters():
    assert evaluate("2*pi/sigma", {"sigma": 40.0}) == 2 * math.pi / 40
    assert names_in("k*sin(k*s + sigma*t) + pi") == {"k", "s", "sigma", "t"}
    with pytest.raises(ExpressionError, match="unknown name 't': it can use pi or sigma"):
        evaluate("sigma*t", {"sigma": 40.0})


def test_equal_by_text_and_parameters():
    first = Expression("k * s", {"k": 2.5})
    assert first == Expression("k  *  s", {"k": 2.5})
    assert hash(first) == hash(Expression("k * s", {"k": 2.5}))
    assert first != Expression("k * s", {"k": 2.6})
    assert first != Expression("k*s", {"k": 2.5})


def test_pickles():
    copy = pickle.loads(pickle.dumps(Expression("k*s + t", P)))
    assert copy == Expression("k*s + t", P)
    assert copy(S, T) == pytest.approx(1.25 * S + T)


def test_parameters_are_bound_at_construction():
    values = {"k": 2.5}
    expression = Expression("k*s", values)
    values["k"] = 9.0
    assert expression(S, 0.0) == pytest.approx(2.5 * S)


def test_precedence_is_that_of_python():
    """Random texts of operators and brackets, beside Python's own parser on NumPy's numbers."""
    rng = random.Random(5)
    found = 0
    for _ in range(2_000):
        words = []
        for _ in range(rng.randint(1, 9)):
            words += [rng.choice(("", "", "-", "+", "(")) + rng.choice(("s", "t", "2", "0.5"))]
            words += [rng.choice((" + ", "-", "*", "/", "**", " % ", "<", ") * ", ")**"))]
        text = "".join(words[:-1])
        text += ")" * (text.count("(") - text.count(")"))
        try:
            compile(text, "text", "eval")
        except SyntaxError:
            with pytest.raises(ExpressionError):
                Expression(text)
            continue
        with np.errstate(all="ignore"):
            numbers = re.sub(r"\b(2|0\.5)\b", r"f(\1)", text)
            expected = eval(numbers, {"s": np.float64(0.3), "t": np.float64(0.4), "f": np.float64})
        found += 1
        assert Expression(text)(0.3, 0.4) == pytest.approx(float(expected), nan_ok=True), text
    assert found > 500
