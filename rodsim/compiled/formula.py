"""Formulas of the case file computed in compiled code, at many points at once.

The operations of :mod:`rodsim.case.functions`, which NumPy computes elsewhere, by number. A formula
is a table (n, 5): operation, three earlier lines that it works on, and a value where it is a
constant. Nothing is compiled for a formula, so none costs a wait.
"""

from __future__ import annotations

import math

import numpy as np

from rodsim.compiled.flags import MAT, kernel, unsigned

VARIABLES = ("x", "y", "z", "t")  # lines of these come first
OF_ONE = ("pos", "neg", "abs", "sign", "floor", "sqrt", "exp", "log", "sin", "cos", "tan", "arcsin",
          "arccos", "arctan", "sinh", "cosh", "tanh")  # fmt: skip
OF_TWO = ("+", "-", "*", "/", "**", "%", "floor_divide", "min", "max", "arctan2", "heaviside", "<",
          "<=", ">", ">=", "==")  # fmt: skip
NAMES = ("constant", "name", "where", *OF_ONE, *OF_TWO)
CODES = {name: code for code, name in enumerate(NAMES)}
CONSTANT, NAME, WHERE = range(3)
(POS, NEG, ABS, SIGN, FLOOR, SQRT, EXP, LOG, SIN, COS, TAN, ARCSIN, ARCCOS, ARCTAN, SINH, COSH,
 TANH) = (CODES[name] for name in OF_ONE)  # fmt: skip
(ADD, SUBTRACT, MULTIPLY, DIVIDE, POWER, MODULO, WHOLE, MIN, MAX, ARCTAN2, HEAVISIDE, LESS,
 LESS_EQUAL, GREATER, GREATER_EQUAL, EQUAL) = (CODES[name] for name in OF_TWO)  # fmt: skip


def table_of(graph, outputs: list[int]) -> tuple[np.ndarray, list[int]]:
    """Return the table of the nodes of a graph, and the lines of some of them."""
    lines, table = {}, [[NAME, 0, 0, 0, 0]] * len(VARIABLES)
    for index, node in enumerate(graph.nodes):
        if node.name:
            lines[index] = VARIABLES.index(node.name)
            continue
        lines[index] = len(table)
        if node.value is not None:
            table.append([CONSTANT, 0, 0, 0, node.value])
        else:
            earlier = [*(lines[argument] for argument in node.arguments), 0, 0]
            table.append([CODES[node.operation], *earlier[:3], 0])
    return np.array(table, dtype=float), [lines[output] for output in outputs]


@unsigned
def _angle_of_one(code, a):
    """Return a circular or hyperbolic function."""
    if code == SIN:
        return np.sin(a)
    if code == COS:
        return np.cos(a)
    if code == TAN:
        return np.tan(a)
    if code == ARCSIN:
        return np.arcsin(a)
    if code == ARCCOS:
        return np.arccos(a)
    if code == ARCTAN:
        return np.arctan(a)
    if code == SINH:
        return np.sinh(a)
    if code == COSH:
        return np.cosh(a)
    return np.tanh(a)


@unsigned
def _of_one(code, a):
    """Return one of the operations on one number."""
    if code == POS:
        return a
    if code == NEG:
        return -a
    if code == ABS:
        return abs(a)
    if code == SIGN:
        return np.sign(a)
    if code == FLOOR:
        return np.floor(a)
    if code == SQRT:
        return np.sqrt(a)
    if code == EXP:
        return np.exp(a)
    if code == LOG:
        return np.log(a)
    return _angle_of_one(code, a)


@unsigned
def _comparison(code, a, b):
    """Return a step, or 1 for true and 0 for false."""
    if code == HEAVISIDE:
        return b if a == 0.0 else (0.0 if a < 0.0 else (1.0 if a > 0.0 else a))
    if code == LESS:
        return 1.0 if a < b else 0.0
    if code == LESS_EQUAL:
        return 1.0 if a <= b else 0.0
    if code == GREATER:
        return 1.0 if a > b else 0.0
    if code == GREATER_EQUAL:
        return 1.0 if a >= b else 0.0
    return 1.0 if a == b else 0.0


@unsigned
def _floor_of_ratio(a, b):
    """Return the floor of a/b from what is left over, as NumPy does: a/b may round to a whole."""
    if b == 0.0:
        return a / b
    left = np.fmod(a, b)
    whole = (a - left) / b
    if left != 0.0 and (left < 0.0) != (b < 0.0):
        whole -= 1.0
    return np.rint(whole)


@unsigned
def _of_two(code, a, b):
    """Return one of the operations on two numbers."""
    if code == ADD:
        return a + b
    if code == SUBTRACT:
        return a - b
    if code == MULTIPLY:
        return a * b
    if code == DIVIDE:
        return a / b
    if code == POWER:
        return a**b
    if code == MODULO:
        return np.mod(a, b)
    if code == WHOLE:
        return _floor_of_ratio(a, b)
    if code == MIN:
        return np.minimum(a, b)
    if code == MAX:
        return np.maximum(a, b)
    if code == ARCTAN2:
        return math.atan2(a, b)
    return _comparison(code, a, b)


@kernel(f"void({MAT}, {MAT})")
def compute(table, work):
    """Compute all lines of a table at n points; work (lines, n) has the variables in its first."""
    for line in range(len(VARIABLES), table.shape[0]):
        code = int(table[line, 0])
        a, b, c = int(table[line, 1]), int(table[line, 2]), int(table[line, 3])
        out = work[line]
        if code == CONSTANT:
            out[:] = table[line, 4]
        elif code == WHERE:
            for i in range(out.size):
                out[i] = work[b, i] if work[a, i] != 0.0 else work[c, i]
        elif code < ADD:
            for i in range(out.size):
                out[i] = _of_one(code, work[a, i])
        else:
            for i in range(out.size):
                out[i] = _of_two(code, work[a, i], work[b, i])
