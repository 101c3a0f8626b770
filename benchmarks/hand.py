"""The sum beside one written by hand for AVX-512: nanoseconds per pair and errors, one core.

    python benchmarks/hand.py

``hand.c`` is that sum, with a square root and a division, or with the processor's estimate of a
reciprocal square root. It needs gcc and AVX-512; without them the table has ours alone.
"""

import ctypes
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from common import Timed, benchmark, curve, interleaved
from tables import Spread, Table

SIZES = (76, 200, 600, 2000)
EPSILON, VISCOSITY = 0.3, 1.7e-6
HAND = {"hand_divide": 0, "hand_estimate": 1}
SAMPLE = 2e-3  # seconds of calls in one call: what is around them does not count


@benchmark(full=21, short=5)
def main(quick, repeats):
    """Measure the sum in free fluid, three-dimensional, algebraic7, beside one written by hand."""
    import numba

    from rodsim.compiled.kernels import address_of
    from rodsim.flows.by_threads import add_velocities

    numba.set_num_threads(1)
    ours = repeated(add_velocities, address_of("rodsim.flows.free:spatial_7"))
    calls = {"ours": ours} | by_hand()
    names = {"points": "M", **{name: name.replace("_", " ") for name in calls}}
    times, ratios, errors = [], [], []
    for size in SIZES:
        scene, row = ring(size), {"points": size}
        count = max(1, round(SAMPLE / (2e-9 * size**2)))
        timers = {name: Timed(once(call, count, scene)) for name, call in calls.items()}
        found = {n: np.array(t) for n, t in interleaved(timers, repeats, f"M = {size}").items()}
        best = found[list(calls)[-1]]
        times.append(row | {n: Spread.of(t, 1e9 / (count * size**2)) for n, t in found.items()})
        ratios.append(row | {n: Spread.of(t / best) for n, t in found.items()})
        errors.append(row | error_row(calls, scene))
    tables = [
        Table("The sum by one core, ns per pair", names, times),
        Table("Ratio to the last, round by round", names, ratios),
        Table("Largest error of u, w over the largest u, w, against 80 bits", names, errors),
    ]
    return tables, lambda *axes: draw(times, names, *axes)


def draw(rows, names, left, right):
    """Left: ns per pair against M."""
    for name in list(names)[1:]:
        curve(left, rows, "points", name, label=names[name])
    left.set(xscale="log", xlabel="M", ylabel="ns per pair", ylim=(0, None))
    left.legend()
    right.set_axis_off()


def repeated(add, run):
    """Return a compiled function that calls a sum as often as asked: no Python between."""
    from numba import njit

    @njit
    def repeat(times, points, loads, epsilon, viscosity, out):
        for _ in range(times):
            add(run, points, points, loads, epsilon, viscosity, 0.0, out)

    return repeat


def by_hand():
    """Compile ``hand.c`` and return its functions as :func:`repeated` does, if they can run."""
    import llvmlite.binding

    if not llvmlite.binding.get_host_cpu_features().get("avx512f"):
        return {}
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
