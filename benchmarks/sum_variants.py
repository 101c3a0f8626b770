"""Variants of the sum in three dimensions for vectors of 512 bits, to be measured by ``hand.py``.

They are made of the source of ``rodsim/flows/free.py``, with another 1/R, other sources.
"""

import inspect
import math
from textwrap import dedent

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic

from rodsim.compiled.flags import SUM_FLAGS, parallel_kernel
from rodsim.flows import free, images

FLAGS = {"error_model": "numpy", "fastmath": SUM_FLAGS}
LANES = 8


def inlined(function):
    return njit(error_model="numpy", inline="always")(function)


def changed(function, names, *replacements, module=free):
    """Make a function again from its source, with other names around it."""
    text = dedent(inspect.getsource(function))
    text = "\n".join(line for line in text.splitlines() if not line.startswith("@"))
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new)
    found = {**module.__dict__, **names}
    exec(compile(text, function.__name__, "exec"), found)
    return inlined(found[function.__name__])


def _estimate(refined):
    @intrinsic
    def estimate(typing, x):
        def generate(context, builder, signature, arguments):
            single = ir.FloatType()
            if not refined:
                known = '"reciprocal-estimates"="vec-sqrtf:0,sqrtf:0"'
                set.add(builder.function.attributes, known)
            root = builder.module.declare_intrinsic("llvm.sqrt", [single])
            value = builder.fptrunc(arguments[0], single)
            value = builder.call(root, [value], fastmath=("fast",))
            value = builder.fdiv(ir.Constant(single, 1.0), value, flags=("fast",))
            return builder.fpext(value, ir.DoubleType())

        return types.float64(types.float64), generate

    return estimate


refined, rough = _estimate(True), _estimate(False)


def cubic(r2, e2):
    x = r2 + e2
    y = refined(x)
    e = 1.0 - x * (y * y)
    return y + y * (e * (0.5 + 0.375 * e))


def quintic(r2, e2):
    x = r2 + e2
    y = rough(x)
    e = 1.0 - x * (y * y)
    return y + y * (e * (0.5 + e * (0.375 + e * (0.3125 + e * 0.2734375))))


def exact(r2, e2):
    return 1.0 / math.sqrt(r2 + e2)


def _eight_roots(context, builder, signature, arguments):
    """Write a[k : k + 8] = 1/sqrt(a[k : k + 8]) with the estimate of AVX-512."""
    array, index = arguments
    double = ir.DoubleType()
    eight = ir.VectorType(double, LANES)
    data = context.make_array(signature.args[0])(context, builder, array).data
    place = builder.bitcast(builder.gep(data, [index]), eight.as_pointer())
    x = builder.load(place, align=8)
    mask = ir.IntType(8)
    kind = ir.FunctionType(eight, [eight, eight, mask])
    name = "llvm.x86.avx512.rsqrt14.pd.512"
    function = builder.module.globals.get(name) or ir.Function(builder.module, kind, name)
    y = builder.call(function, [x, ir.Constant(eight, ir.Undefined), ir.Constant(mask, -1)])

    def const(a):
        return ir.Constant(eight, [ir.Constant(double, a)] * LANES)

    flags = ("contract",)
    e = builder.fsub(const(1.0), builder.fmul(builder.fmul(x, y), y, flags=flags), flags=flags)
    polynomial = const(0.3125)
    for c in (0.375, 0.5):
        polynomial = builder.fadd(builder.fmul(polynomial, e, flags=flags), const(c), flags=flags)
    ye = builder.fmul(y, e, flags=flags)
    y = builder.fadd(builder.fmul(ye, polynomial, flags=flags), y, flags=flags)
    builder.store(y, place, align=8)
    return context.get_dummy_value()


@intrinsic
def eight_roots(typing, array, index):
    return types.void(array, types.intp), _eight_roots


@inlined
def padded(sources, loads):
    """Return the sources up to whole vectors: the last one again, without load."""
    count = sources.shape[1]
    whole = (count + LANES - 1) // LANES * LANES
    more, theirs = np.empty((3, whole)), np.zeros((6, whole))
    for c in range(3):
        for k in range(count):
            more[c, k] = sources[c, k]
            theirs[c, k] = loads[c, k]
            theirs[c + 3, k] = loads[c + 3, k]
        for k in range(count, whole):
            more[c, k] = sources[c, count - 1]
    return more, theirs


def one_pass(inverse):
    pair = changed(free.add_pair.py_func, {"inverse_distance": inlined(inverse)})
    return changed(free.add_up.py_func, {"add_pair": pair})


def two_passes():
    pair = changed(
        free.add_pair.py_func,
        {},
        ("inverse = inverse_distance(r2, e2)", ""),
        ("e2, sums)", "e2, sums, inverse)"),
    )
    return changed(
        free.add_up.py_func,
        {"add_pair": pair, "eight_roots": eight_roots, "np": np},
        (
            "    sums =",
            "    a = np.empty(sources.shape[1])\n"
            "    for k in range(sources.shape[1]):\n"
            "        rx, ry, rz = x - sources[0, k], y - sources[1, k], z - sources[2, k]\n"
            "        a[k] = rx * rx + ry * ry + rz * rz + e2\n"
            "    for n in range(sources.shape[1] // 8):\n"
            "        eight_roots(a, 8 * n)\n"
            "    sums =",
        ),
        ("m, e2, sums)", "m, e2, sums, a[k])"),
    )


def at_wall(inverse):
    """Return the sum at a wall, z = -3, with two 1/R in its first pass."""
    inverse = inlined(inverse)

    @inlined
    def both(r, zh, e2):
        rx, ry, d = r
        r2 = rx * rx + ry * ry + d * d
        return inverse(r2, e2), inverse(r2 + 4.0 * zh, e2)

    first = changed(
        images._all_inverse_distances.py_func, {"inverse_distances": both}, module=images
    )
    return changed(images.add_up.py_func, {"_all_inverse_distances": first}, module=images)


def kernel(add_up, pad, decorate, planar=False, wall=False):
    @inlined
    def one(i, targets, sources, loads, e2, scale, out):
        x, y, z = targets[0, i], targets[1, i], targets[2, i]
        if wall:
            six = add_up(7, planar, True, x, y, z, sources, loads, -3.0, e2)
        else:
            six = add_up(7, planar, True, x, y, z, sources, loads, e2)
        ux, uy, uz, wx, wy, wz = six
        out[0, i] += scale * ux
        out[1, i] += scale * uy
        out[2, i] += scale * uz
        out[3, i] += scale * wx
        out[4, i] += scale * wy
        out[5, i] += scale * wz

    prange = free.prange

    @decorate
    def fused_sum(targets, sources, loads, epsilon, viscosity, out):
        e2 = epsilon * epsilon
        scale = 1.0 / (free.EIGHT_PI * viscosity)
        if pad:
            sources, loads = padded(sources, loads)
        for i in prange(targets.shape[1]):
            one(i, targets, sources, loads, e2, scale, out)

    return fused_sum


serial = njit(**FLAGS)


def variants():
    """Return the kernels by name."""
    from hand import has_avx512

    parallel = parallel_kernel
    wide = {"two_pass": kernel(two_passes(), True, serial)} if has_avx512() else {}
    return wide | {
        "now": free.SPATIAL_7,
        "serial": kernel(one_pass(exact), False, serial),
        "padded": kernel(one_pass(exact), True, serial),
        "cubic": kernel(one_pass(cubic), True, serial),
        "quintic": kernel(one_pass(quintic), True, serial),
        "cubic_prange": kernel(one_pass(cubic), True, parallel),
    }


def other_sums():
    """Return kernels of a planar scene and at a wall: as they are, padded, with estimates."""
    found = {}
    for planar in (False, True):
        name = "planar" if planar else "spatial"
        for root, inverse, pad in (
            ("", exact, False),
            ("_padded", exact, True),
            ("_cubic", cubic, True),
        ):
            if planar:
                found[f"{name}{root}"] = kernel(one_pass(inverse), pad, serial, planar)
            add_up = at_wall(inverse) if root == "_cubic" else images.add_up
            found[f"wall_{name}{root}"] = kernel(add_up, pad, serial, planar, True)
    return found
