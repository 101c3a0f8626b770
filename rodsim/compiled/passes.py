"""The vector arithmetic of a step, one compiled pass a formula: numpy makes one an operator."""

import math

import numpy as np

from rodsim.compiled.flags import inline
from rodsim.compiled.rotations import rotation_vector_rate


@inline
def weighted_sum(a, x, b, y, out):
    """out = a x + b y."""
    for i in range(np.uint64(out.size)):
        out[i] = a * x[i] + b * y[i]


@inline
def _largest_rms(values, weights, first, count):
    """Return the largest weighted root mean square of a rod's numbers, or of all tracers'.

    values : as increments, six rows of all N nodes, then three of the P tracers. NaN if one is.
    """
    n = 0
    for r in range(count.size):
        n += count[r]
    largest = 0.0
    for r in range(count.size):
        total = 0.0
        for c in range(6):
            for k in range(c * n + first[r], c * n + first[r] + count[r]):
                total += (weights[k] * values[k]) ** 2
        rms = math.sqrt(total / (6 * count[r]))
        largest = rms if rms > largest or rms != rms else largest
    total = 0.0
    for i in range(6 * n, weights.size):
        total += (weights[i] * values[i]) ** 2
    if weights.size > 6 * n:
        rms = math.sqrt(total / (weights.size - 6 * n))
        largest = rms if rms > largest or rms != rms else largest
    return largest


@inline
def remaining(size, c, memory, y, velocities, f0, g, weights, first, count, f1, third, error):
    """Return how large the error is that a trial step leaves, see ``Defect.correction``.

    Writes the rates at its end, y''' and the error of each number.
    """
    h3 = size * size * size
    scale = 1.0 / (h3 * (1.0 / 12.0 + memory * c))
    n = first[-1] + count[-1]
    for i in range(np.uint64(y.size)):
        f1[i] = velocities[i]
    rotation_vector_rate(y[3 * n : 6 * n].reshape(3, n), f1[3 * n : 6 * n].reshape(3, n))
    for i in range(np.uint64(y.size)):
        rest = 0.5 * size * (f0[i] + f1[i]) - y[i] + memory * size * g[i]
        third[i] = scale * rest
    for i in range(np.uint64(y.size)):
        error[i] = c * h3 * third[i] - size * g[i]
    return _largest_rms(error, weights, first, count)


@inline
def probe(size, direction, weights, y):
    """y = size direction/weights, in the first ``weights.size`` numbers."""
    for i in range(np.uint64(weights.size)):
        y[i] = size * direction[i] / weights[i]


@inline
def image(size, shifted, rate, weights, out):
    """out = weights (shifted - rate)/size, in the first ``weights.size`` numbers."""
    for i in range(np.uint64(weights.size)):
        out[i] = weights[i] * (shifted[i] - rate[i]) / size
