"""The vector arithmetic of a step, one compiled pass a formula: numpy makes one an operator."""

import math

import numpy as np

from rodsim.compiled.flags import VEC, kernel


@kernel(f"void(float64, {VEC}, float64, {VEC}, {VEC})")
def weighted_sum(a, x, b, y, out):
    """out = a x + b y."""
    for i in range(np.uint64(out.size)):
        out[i] = a * x[i] + b * y[i]


@kernel(f"float64(float64, float64, float64, {VEC}, {VEC}, {VEC}, {VEC}, {VEC}, {VEC})")
def defect(size, c, memory, y, f0, f1, g, weights, third):
    """Write y''' and return the weighted rms of the error left, see ``Defect.remaining``.

    The rms is over the first ``weights.size`` numbers; NaN if one of them is.
    """
    h3 = size * size * size
    scale = 1.0 / (h3 * (1.0 / 12.0 + memory * c))
    total = 0.0
    for i in range(np.uint64(y.size)):
        rest = 0.5 * size * (f0[i] + f1[i]) - y[i] + memory * size * g[i]
        third[i] = scale * rest
    for i in range(np.uint64(weights.size)):
        total += (weights[i] * (c * h3 * third[i] - size * g[i])) ** 2
    return math.sqrt(total / weights.size)


@kernel(f"void(float64, {VEC}, {VEC}, {VEC})")
def probe(size, direction, weights, y):
    """y = size direction/weights, in the first ``weights.size`` numbers."""
    for i in range(np.uint64(weights.size)):
        y[i] = size * direction[i] / weights[i]


@kernel(f"void(float64, {VEC}, {VEC}, {VEC}, {VEC})")
def image(size, shifted, rate, weights, out):
    """out = weights (shifted - rate)/size, in the first ``weights.size`` numbers."""
    for i in range(np.uint64(weights.size)):
        out[i] = weights[i] * (shifted[i] - rate[i]) / size
