"""The fast sum against the exact one: time, error, lists and memory up to 1 000 000 points."""

import time

import click
import numpy as np
from common import Timed, benchmark, curve, interleaved
from curves import EPSILON, SCENES
from tables import Spread, Table

VISCOSITY = 0.7
SIZES, QUICK = (1000, 10_000, 100_000, 1_000_000), (1000, 10_000)
ACCURACIES, QUICK_ACCURACIES = (1e-3, 1e-5, 1e-7), (1e-3, 1e-5)
EVERY = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)  # of the picture of error against cost
FEW = (60, 90, 130, 200, 300, 450, 700, 1000, 1500, 2200, 3300)  # M among which it begins to pay
TARGETS = 300  # at which the exact sum is computed and timed
COLUMNS = {
    "scene": "scene",
    "points": "M",
    "accuracy": "asked",
    "ratio": "exact / fast",
    "fast": "fast, ms",
    "u": "error of u",
    "w": "error of w",
    "lists": "lists, ms",
    "prepare": "lists and measuring, ms",
    "near": "pairs a point",
    "bytes": "bytes a point",
}
ACCURACY_COLUMNS = {key: COLUMNS[key] for key in ("scene", "accuracy", "fast", "u", "w", "near")}
EVEN = {
    "scene": "scene",
    "accuracy": "asked",
    "alone": "pays from M",
    "lists": "with lists for every evaluation",
}


@benchmark(full=5, short=3)
@click.option("--points", multiple=True, type=click.IntRange(1000), help="M; again for more.")
@click.option(
    "--scene", "names", multiple=True, type=click.Choice(tuple(SCENES)), help="Again for more."
)
@click.option("--threads", type=click.IntRange(1), default=1, show_default=True)
@click.option("--above", type=click.FloatRange(0.6), help="Lowest point over a wall, in epsilon.")
@click.option("--flat", type=click.FloatRange(0), default=1.0, help="Heights times this.")
def main(quick, repeats, points, names, threads, above, flat):
    """Measure fast sums of random loads, the worst case, on one thread.

    The exact sum is timed at 300 of the points and scaled; both in CPU time, in rounds, so that
    what others do meanwhile disturbs little and both sides alike. Errors are relative, root mean
    square over those points.
    """
    import numba

    numba.set_num_threads(threads)
    sizes = points or (QUICK if quick else SIZES)
    accuracies = QUICK_ACCURACIES if quick else ACCURACIES
    rows = []
    for name in names or SCENES:
        for size in sizes:
            if size == 1_000_000 and name != "suspension":
                continue  # minutes for each
            rows += [measure(name, size, a, repeats, above, flat) for a in accuracies]
    picture = [measure("coil, 25 epsilon", 10_000, a, repeats, above, flat) for a in EVERY]
    tables = [Table("Fast sums", COLUMNS, rows), Table("Error against cost", COLUMNS, picture)]
    curves = [name for name in names or SCENES if name != "suspension"]
    even = [break_even(name, a, repeats, above, flat) for name in curves for a in accuracies]
    tables.append(Table("Break-even", EVEN, even))
    return tables, lambda *axes: draw(rows, picture, *axes)


def measure(name, size, accuracy, repeats, above=None, flat=1.0):
    """Return the row of a scene, above a wall z = 0 where ``above`` is given."""
    from rodsim.flows.fast.plan import relative_error, rod_sum

    X, counts = SCENES[name](size)
    X[2] *= flat
    if above is not None:
        X[2] += above * EPSILON - X[2].min()
    wall = None if above is None else 0.0
    loads = np.random.default_rng(3).normal(size=(6, size))
    loads[3:] *= EPSILON
    begin = time.process_time()
    fast = rod_sum(X, counts, accuracy, EPSILON, VISCOSITY, "algebraic7", wall_height=wall)
    begin = time.process_time()
    fast.count(X)
    lists = time.process_time() - begin
    begin = time.process_time()
    tables = fast.prepare(X, loads)
    prepare = time.process_time() - begin
    sample = np.unique(np.linspace(0, size - 1, TARGETS).astype(int))
    targets, exact = np.ascontiguousarray(X[:, sample]), np.zeros((6, len(sample)))
    out = np.zeros_like(loads)

    def quick():
        out[:] = 0.0
        fast.kernel(tables, X, loads, False, out)

    def slow():
        exact[:] = 0.0
        fast.exact(targets, X, loads, *fast.fluid, exact)

    calls = {
        "fast": Timed(quick, clock=time.process_time),
        "exact": Timed(slow, clock=time.process_time),
    }
    spent = interleaved(calls, repeats, f"{name}, {size}, {accuracy:g}")
    whole = np.array(spent["exact"]) * size / len(sample)
    u, w = relative_error(out[:, sample], exact)
    return {
        "scene": name, "points": size, "accuracy": accuracy,
        "ratio": Spread.of(whole / np.array(spent["fast"])), "fast": Spread.of(spent["fast"], 1e3),
        "exact": Spread.of(whole, 1e3), "u": u, "w": w, "lists": 1e3 * lists,
        "prepare": 1e3 * prepare, "near": fast.pairs / size, "bytes": tables.nbytes / size,
    }  # fmt: skip


def break_even(name, accuracy, repeats, above, flat):
    """Return from which of some M on a fast sum takes less time, without lists and with them."""
    found = {"scene": name, "accuracy": accuracy}
    for size in FEW:
        row = measure(name, size, accuracy, repeats, above, flat)
        for key, more in (("alone", 0.0), ("lists", row["prepare"])):
            if key not in found and row["fast"].median + more < row["exact"].median:
                found[key] = size
    return found


def draw(rows, picture, left, right):
    """Left: exact and fast against M; right: error against the cost of the sum."""
    for k, name in enumerate({row["scene"]: 0 for row in rows}):
        chosen = [row for row in rows if row["scene"] == name and row["accuracy"] == 1e-5]
        curve(left, chosen, "points", "fast", label=f"{name}, 1e-5", color=f"C{k}")
        if k == 0:
            curve(left, chosen, "points", "exact", label="exact", color="k", linestyle="--")
    left.set(xscale="log", yscale="log", xlabel="M", ylabel="an evaluation, ms")
    left.legend(fontsize="small")
    cost = [row["fast"].median for row in picture]
    right.loglog(cost, [row["u"] for row in picture], marker="o", label="u")
    right.loglog(cost, [row["w"] for row in picture], marker="s", label="w")
    right.axvline(picture[-1]["exact"].median, color="k", linestyle="--", label="exact")
    right.set(xlabel="an evaluation of 10 000 points, ms", ylabel="relative error")
    right.legend()


if __name__ == "__main__":
    main()
