"""Formulas in compiled code: operation by operation against NumPy."""

import numpy as np
import pytest

from rodsim.case.expressions import Expression
from rodsim.case.functions import OPERATIONS
from rodsim.case.graph import Graph
from rodsim.compiled import formula

VARIABLES = formula.VARIABLES
EVERY = np.array([0.0, -0.0, 0.37, -0.37, 2.9, -2.9, 7.25, -7.25, 41.3, 710.0, 1e-320, 1e200,
                  np.inf, -np.inf, np.nan, 0.1, -0.1, 3.0, -3.0, 2.0**52 + 1.0])  # fmt: skip
CLOSE = 4 * np.finfo(float).eps  # of libraries that round a transcendental function differently


def computed(graph, outputs, points):
    """Return the values (outputs, n) of nodes of a graph at points (4, n)."""
    table, lines = formula.table_of(graph, outputs)
    work = np.empty((len(table), points.shape[1]))
    work[: len(VARIABLES)] = points
    with np.errstate(all="ignore"):  # where the JIT is off it is NumPy that computes
        formula.compute(table, work)
    return work[lines]


def triples():
    """All triples of special and plain numbers, as x, y, z; t is one more."""
    x, y, z = (a.ravel() for a in np.meshgrid(EVERY, EVERY, EVERY[[0, 2, 3, 14]], indexing="ij"))
    return np.array([x, y, z, np.full(x.size, 0.83)])


def test_no_operation_is_missing():
    assert set(formula.OF_ONE) | set(formula.OF_TWO) | {"where"} == set(OPERATIONS)


@pytest.mark.parametrize("operation", OPERATIONS)
def test_an_operation_is_that_of_numpy_also_of_inf_and_nan(operation):
    count = 3 if operation == "where" else 1 + (operation in formula.OF_TWO)
    graph, points = Graph(), triples()
    node = graph.apply(operation, *(graph.name(name) for name in "xyz"[:count]))
    (found,) = computed(graph, [node], points)
    with np.errstate(all="ignore"):
        expected = OPERATIONS[operation](*points[:count])
    assert found == pytest.approx(expected, rel=CLOSE, abs=0.0, nan_ok=True)
    assert (np.isnan(found) == np.isnan(expected)).all()


FORMULAS = (
    "0.7*z - sin(2.3*x + t)*cos(y)/(x**2 + 0.9)",
    "where(z > 0.2*t, exp(-y**2), -3.1) + x % 0.6",
    "max(x, y, z)*arctan2(y, 1.3 + abs(x)) - floor(z/0.4)",
    "4.2*z*(3.7 - z)/3.7**2",
    "5.3",
    "t",
)


@pytest.mark.parametrize("text", FORMULAS)
def test_a_formula_and_its_slopes_are_those_of_the_case_file(text):
    points = np.random.default_rng(7).uniform(-2.3, 2.9, (4, 700))
    wanted = [Expression(text, {}, VARIABLES)]
    wanted += [wanted[0].derivative(name) for name in VARIABLES]
    graph = Graph()
    found = computed(graph, [each.add_to(graph) for each in wanted], points)
    expected = np.array([each(*points) for each in wanted])
    # Rounding of a few operations on numbers near 10.
    assert found == pytest.approx(expected, rel=1e-13, abs=1e-13)


def test_what_is_written_twice_is_computed_once():
    graph, text = Graph(), "sin(x*t + y)"
    nodes = [Expression(f"{text}*{c}", {}, VARIABLES).add_to(graph) for c in (2.3, 3.7)]
    table, _ = formula.table_of(graph, nodes)
    assert (table[:, 0] == formula.CODES["sin"]).sum() == 1
