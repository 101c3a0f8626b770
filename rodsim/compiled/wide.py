"""Sums with vectors of 512 bits: whole vectors of sources, and 1/R from the processor's estimate.

A square root and a division of eight numbers take as long as the rest of a planar sum. There is an
estimate of 1/sqrt in single precision, good to 1.5 2^-12, and LLVM uses it where a loop divides by
a root of such numbers and allows it; one step of fifth order makes a double of it. Of 256 bits the
root and the division are the faster (docs/notes/performance.md), so there all stays as it is.

LLVM takes two attributes of the function for it: that the vectors may be of 512 bits, which it does
not choose by itself on Intel's processors, and that the estimate needs no step of its own. They
change nobody else's code.
"""

import math

import llvmlite.binding
import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from rodsim.compiled.flags import ONE, inline, unsigned
from rodsim.compiled.kernels import jit_is_off

LANES = 8
ATTRIBUTES = '"prefer-vector-width"="512"', '"reciprocal-estimates"="vec-sqrtf:0,sqrtf:0"'


def _wide() -> bool:
    """Tell whether Numba compiles for a processor with vectors of 512 bits, and may use them."""
    asked = numba.config.CPU_FEATURES
    try:
        asked = asked or llvmlite.binding.get_host_cpu_features().flatten()
    except RuntimeError:  # LLVM does not know them on every system
        return False
    features = asked.split(",")
    return "+avx512f" in features and "+prefer-256-bit" not in features and not jit_is_off()


WIDE = _wide()


@intrinsic
def _estimate(typing, x):
    """Return 1/sqrt(x) to 1.5 2^-12, for x that single precision can hold."""

    def generate(context, builder, signature, arguments):
        for each in ATTRIBUTES:
            set.add(builder.function.attributes, each)  # llvmlite knows only some by name
        single = ir.FloatType()
        root = builder.module.declare_intrinsic("llvm.sqrt", [single])
        narrow = builder.fptrunc(arguments[0], single)
        divisor = builder.call(root, [narrow], fastmath=("fast",))
        found = builder.fdiv(ir.Constant(single, 1.0), divisor, flags=("fast",))
        return builder.fpext(found, ir.DoubleType())

    return types.float64(types.float64), generate


@inline
def inverse_root(x):
    """Return 1/sqrt(x) = y (1 - e)^(-1/2), e = 1 - x y^2 of an estimate y, to 1e-16 or so."""
    y = _estimate(x)
    e = 1.0 - x * (y * y)
    return y + y * (e * (0.5 + e * (0.375 + e * (0.3125 + e * 0.2734375))))


@unsigned
def unit_of(epsilon):
    """Return the power of two by which lengths are multiplied, so that epsilon is 1/2 to 1."""
    return math.ldexp(1.0, -math.frexp(epsilon)[1])


@unsigned
def whole_vectors(sources, loads, unit):
    """Return sources and loads in units of length 1/``unit``, up to a whole number of vectors.

    The last source is there again, without load: a rest would be summed one by one, which takes
    as long as whole vectors of it.
    """
    count = np.uint64(sources.shape[1])
    whole = (sources.shape[1] + LANES - 1) // LANES * LANES
    places, theirs = np.empty((3, whole)), np.empty((6, whole))
    for c in range(3):
        for k in range(count):
            places[c, k] = unit * sources[c, k]
            theirs[c, k] = loads[c, k]
            theirs[c + 3, k] = unit * loads[c + 3, k]
        for k in range(count, np.uint64(whole)):
            places[c, k] = places[c, count - ONE]
            theirs[c, k] = theirs[c + 3, k] = 0.0
    return places, theirs
