"""The sum beside one written by hand for AVX-512: nanoseconds per pair and errors, one core.

    python benchmarks/hand.py

``hand.c`` is that sum, with a square root and a division, or with the processor's estimate of a
reciprocal square root. It needs gcc and AVX-512; without them the table has ours alone.
"""

import ctypes
import subprocess
import tempfile
from pathlib import Path
from time import perf_counter

import numpy as np
from common import Timed, benchmark, interleaved
from tables import Spread, Table

SIZES = (76, 200, 600, 2000)
EPSILON, VISCOSITY = 0.3, 1.7e-6
HAND = {"hand_divide": 0, "hand_estimate": 1}
SAMPLE = 2e-3  # seconds of calls in one call: what is around them does not count


@benchmark(full=9, short=3)
def main(quick, repeats):
    """Measure the sum in free fluid, three-dimensional, algebraic7, beside one written by hand."""
    import numba

    numba.set_num_threads(1)
    begin = perf_counter()
    calls = {name: repeated(kernel) for name, kernel in kernels().items()}
    if has_avx512():
        calls |= by_hand()
    tables = compared(calls, repeats, "the sum")
    tables += compared({n: repeated(k) for n, k in kernels(other=True).items()}, repeats, "others")
    print(f"{perf_counter() - begin:.0f} s")
    return tables, None


def compared(calls, repeats, label):
    """Return the tables of ns per pair, ratios to the last call, errors against the exact sum."""
    times, errors = {}, []
    for size in SIZES:
        scene = ring(size)
        count = max(1, round(SAMPLE / (2e-9 * size**2)))
        timers = {name: Timed(once(call, count, scene)) for name, call in calls.items()}
        rounds = interleaved(timers, repeats, f"M = {size}")
        times[size] = {name: np.array(rounds[name]) / count for name in calls}
        if label == "the sum":
            errors.append({"points": size, **error_row(calls, scene)})
    names = {"points": "M", **{name: name.replace("_", " ") for name in calls}}
    rows = [
        {"points": size} | {n: Spread.of(t, 1e9 / size**2) for n, t in times[size].items()}
        for size in SIZES
    ]
    base = list(calls)[-1]
    ratios = [
        {"points": size} | {n: Spread.of(t / times[size][base]) for n, t in times[size].items()}
        for size in SIZES
    ]
    return [
        Table(f"{label}, ns per pair", names, rows),
        Table(f"over {names[base]}, round by round", names, ratios),
        Table("largest error of u, w over the largest u, w; against 80 bits", names, errors),
    ]


def kernels(other=False):
    from sum_variants import other_sums, variants

    return other_sums() if other else variants()


def repeated(kernel):
    """Return a compiled function that calls a kernel as often as asked: no Python between."""
    from numba import njit

    @njit
    def repeat(times, points, loads, epsilon, viscosity, out):
        for _ in range(times):
            kernel(points, points, loads, epsilon, viscosity, out)

    return repeat


def has_avx512():
    """Tell whether this processor has vectors of 512 bits."""
    import llvmlite.binding

    return bool(llvmlite.binding.get_host_cpu_features().get("avx512f"))


def by_hand():
    """Compile ``hand.c`` and return its functions as :func:`repeated` does."""
    source = Path(__file__).with_name("hand.c")
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / "hand.so"
        flags = ["-O3", "-march=native", "-shared", "-fPIC"]
        subprocess.run(["gcc", *flags, "-o", library, source], check=True)
        code = ctypes.CDLL(str(library))
    pointer, double = np.ctypeslib.ndpointer(float, flags="C"), ctypes.c_double
    code.repeat.argtypes = [
        ctypes.c_int,
        *[ctypes.c_long] * 3,
        *[pointer] * 3,
        double,
        double,
        pointer,
    ]

    def call(root, times, points, loads, epsilon, viscosity, out):
        size, scale = points.shape[1], 1.0 / (8.0 * np.pi * viscosity)
        code.repeat(root, times, size, size, points, points, loads, epsilon**2, scale, out)

    return {name: lambda *rest, root=root: call(root, *rest) for name, root in HAND.items()}


def ring(size):
    """Return points of a ring, loads at random."""
    angle = np.arange(size) * (2.0 * np.pi / size)
    points = 2.5 * np.stack([0.1 * np.sin(3.0 * angle), np.cos(angle), np.sin(angle)])
    return points, np.random.default_rng(1).standard_normal((6, size))


def once(call, count, scene):
    out = np.zeros_like(scene[1])
    return lambda: call(count, *scene, EPSILON, VISCOSITY, out)


def error_row(calls, scene):
    """Return the errors of u, w, each over the largest, in one number."""
    exact = exact_sum(*scene)
    sizes = np.repeat([np.abs(part).max() for part in (exact[:3], exact[3:])], 3)[:, None]
    row = {}
    for name, call in calls.items():
        out = np.zeros_like(scene[1])
        call(1, *scene, EPSILON, VISCOSITY, out)
        row[name] = f"{float((np.abs(out - exact) / sizes).max()):.1e}"
    return row


def exact_sum(points, loads):
    """Return (61), (66) for algebraic7 in numbers of 80 bits (kernels (63)-(68))."""
    points, loads = points.astype(np.longdouble), loads.astype(np.longdouble)
    e2 = np.longdouble(EPSILON) ** 2
    out = np.zeros_like(loads)
    g, m = loads[:3], loads[3:]
    for i, x in enumerate(points.T):
        r = x[:, None] - points
        r2 = (r * r).sum(0)
        R = np.sqrt(r2 + e2)
        h1, h2, q = (2 * e2 + r2) / R**3, 1 / R**3, (5 * e2 + 2 * r2) / R**5
        d1 = (10 * e2**2 - 7 * e2 * r2 - 2 * r2**2) / R**7
        d2 = (21 * e2 + 6 * r2) / R**7
        mr, gr = np.cross(m, r, axis=0), np.cross(g, r, axis=0)
        out[:3, i] = (g * h1 + (g * r).sum(0) * r * h2 + mr * q / 2).sum(1)
        out[3:, i] = (gr * q / 2 + m * d1 / 4 + (m * r).sum(0) * r * d2 / 4).sum(1)
    return out / (8 * np.pi * VISCOSITY)


if __name__ == "__main__":
    main()
