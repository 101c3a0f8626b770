"""Cost of one evaluation, and memory, against the number of points; error against cost of a sum."""

import csv
import functools
import time
import tracemalloc

import click
from common import (
    CONFIGS,
    Timed,
    benchmark,
    curve,
    interleaved,
    thread_counts,
    threads_option,
)
from large import ACCURACY_COLUMNS, EVERY, TARGETS
from large import measure as measure_sum
from pieces import elasticity_of, fast_sum_of, gpu_sum_of, sum_of
from tables import Spread, Table

SIZES = (50, 100, 200, 500, 1000, 2000, 5000, 10_000, 30_000, 100_000, 300_000, 1_000_000)
QUICK_LARGEST = 5000
SAMPLED = 10_000  # points from which the exact sum is timed at some of them, and scaled
ACCURACY = 1e-5
ERROR_SCENES, ERROR_POINTS = ("suspension", "coil, 25 epsilon"), 10_000
# From so many points on a fast sum of another kind was faster than the exact one, as published, by
# accuracy: N. A. Gumerov & R. Duraiswami, J. Comput. Phys. 215 (2006) 363-383, abstract: a fast
# multipole method for the biharmonic kernel, the scalar that Stokes flow is made of.
PUBLISHED = {1e-4: 550, 1e-12: 3550}
COLUMNS = {
    "points": "M",
    "threads": "threads",
    "elastic": "elasticity alone, ms",
    "sum": "exact sum, ms",
    "pair": "exact sum, ns/pair",
    "fast": "fast sum, ms",
    "ratio": "exact / fast",
    "gpu": "exact sum on a GPU, ms",
    "whole": "evaluation, exact, ms",
    "fast_whole": "evaluation, fast, ms",
    "repeats": "repeats",
    "build": "case and scene, ms",
    "memory": "memory, kB",
    "per_point": "bytes per point",
}


@benchmark(full=15, short=5)
@threads_option
@click.option("--points", multiple=True, type=click.IntRange(50), help="M; again for more sizes.")
@click.option("--gpu", "gpu_path", metavar="FILE", type=click.Path(exists=True, dir_okay=False),
              help="A CSV file with columns points and gpu (ms), measured elsewhere.")  # fmt: skip
def main(quick, repeats, threads, points, gpu_path):
    """Measure one evaluation of a ring of M points: elasticity, sums, and the memory it needs.

    From 10 000 points on the exact sum is timed at 300 of the points, evenly spread, and scaled.
    One thread is timed in seconds of CPU, which others disturb little, several by the wall.
    Fast sums are asked for an accuracy of 1e-5; their lists are made before. Where there is a GPU
    that rodsim can use, it is timed as well. Memory is what the arrays of the case, the scene, the
    system and one pair of increment vectors take, as NumPy counts it.
    """
    largest = QUICK_LARGEST if quick else SIZES[-1]
    sizes = sorted(points) or [size for size in SIZES if size <= largest]
    counts, elsewhere = thread_counts(threads), read_gpu(gpu_path)
    rows = [row for size in sizes for row in measure(size, counts, repeats, elsewhere)]
    errors = [measure_sum(name, ERROR_POINTS, a, min(repeats, 5)) for name in ERROR_SCENES
              for a in (EVERY[::3] if quick else EVERY)]  # fmt: skip
    tables = [
        Table("One evaluation", COLUMNS, rows),
        Table("Error against cost", ACCURACY_COLUMNS, errors),
    ]
    return tables, lambda *axes: draw(rows, errors, *axes)


def read_gpu(path):
    """Return milliseconds on a GPU by number of points, as another machine has measured them."""
    if path is None:
        return {}
    with open(path, newline="") as stream:
        lines = csv.DictReader(line for line in stream if not line.startswith("#"))
        return {int(row["points"]): float(row["gpu"]) for row in lines if row.get("gpu")}


def measure(size, counts, repeats, elsewhere):
    """Return the rows of one size, one for each number of threads."""
    repeats = repeats if size < 30_000 else min(repeats, 3)
    evaluations = {count: Evaluation(size, count) for count in counts}
    results = interleaved(evaluations, repeats, f"M = {size}")
    gpu = on_gpu(evaluations[counts[0]].scene, repeats, elsewhere)
    rows = []
    for count, parts in results.items():
        spent = evaluations[count]
        columns = {key: [part[key] for part in parts] for key in parts[0]}
        ratio = [a / b for a, b in zip(columns["sum"], columns["fast"], strict=True)]
        rows.append(
            {
                "points": size,
                "threads": count,
                **{key: Spread.of(seconds, 1e3) for key, seconds in columns.items()},
                "pair": Spread.of(columns["sum"], 1e9 / size**2),
                "ratio": Spread.of(ratio),
                "repeats": repeats,
                "build": 1e3 * spent.build_seconds,
                "memory": spent.memory / 1024,
                "per_point": spent.memory / size,
                **gpu,
            }
        )
    return rows


def on_gpu(scene, repeats, elsewhere):
    """Return the column of the GPU: measured here, or elsewhere, or none."""
    size = scene.rods.points
    if call := gpu_sum_of(scene):
        timed = Timed(call)
        return {"gpu": Spread.of([timed() for _ in range(repeats)], 1e3)}
    return {"gpu": Spread.of([elsewhere[size]])} if size in elsewhere else {}


class Evaluation:
    """Call it for the seconds of the pieces of one evaluation, each timed alone, by name."""

    def __init__(self, size, threads):
        self._build(size)  # imports and compiles
        tracemalloc.start()
        system = self._build(size)
        self.memory, _ = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        begin = time.perf_counter()
        system = self._build(size)
        self.build_seconds = time.perf_counter() - begin
        self.scene, targets = system.scene, None if size < SAMPLED else TARGETS
        self.scale = 1.0 if targets is None else size / targets
        pieces = {
            "elastic": elasticity_of(self.scene, threads),
            "sum": sum_of(self.scene, threads, targets),
            "fast": fast_sum_of(self.scene, threads, ACCURACY),
            "fast_whole": whole(self._build(size, [f"fluid.sums.accuracy={ACCURACY}"]), threads),
        }
        pieces |= {"whole": whole(system, threads)} if targets is None else {}
        clock = time.process_time if threads == 1 else time.perf_counter
        timed = functools.partial(Timed if targets is None else _once, clock=clock)
        self.pieces = {name: timed(piece) for name, piece in pieces.items()}

    def _build(self, size, changes=()):
        from rodsim.case import load_case
        from rodsim.scene.build import build_scene
        from rodsim.scene.system import RodSystem

        case = load_case(CONFIGS / "closed_ring.yaml", [f"rods.ring.shape.points={size}", *changes])
        system = RodSystem(build_scene(case))
        self.increments, self.rates = system.zeros(), system.zeros()
        return system

    def __call__(self):
        seconds = {name: piece() for name, piece in self.pieces.items()}
        seconds["sum"] *= self.scale
        return seconds


def whole(system, threads):
    """Return a function that makes one evaluation of a scene, after its lists are made."""
    import numba

    increments, rates, state = system.zeros(), system.zeros(), system.scene.initial
    system.rate(0.0, state, increments, rates)

    def evaluate():
        numba.set_num_threads(threads)
        system.rate(0.0, state, increments, rates)

    return evaluate


def _once(call, clock):
    """Return what gives the seconds of one call; large sizes need no warming up."""

    def seconds():
        begin = clock()
        call()
        return clock() - begin

    return seconds


def draw(rows, errors, left, right):
    """Left: pieces against M, and published break-evens; right: error against cost of a sum."""
    count = max(row["threads"] for row in rows)
    chosen = [row for row in rows if row["threads"] == count]
    parts = {"sum": "exact sum", "fast": "fast sum, 1e-5", "gpu": "exact sum on a GPU",
             "elastic": "elasticity"}  # fmt: skip
    for k, (key, label) in enumerate(parts.items()):
        if any(key in row for row in chosen):
            curve(left, chosen, "points", key, label=label, color=f"C{k}")
    for accuracy, points in PUBLISHED.items():
        left.axvline(points, color="0.5", linestyle=":")
        label, at = f" {accuracy:.0e}".replace("e-0", "e-"), (points, 0.01)
        style = {"rotation": 90, "va": "bottom", "color": "0.4", "fontsize": "small"}
        left.annotate(label, at, xycoords=("data", "axes fraction"), **style)
    left.plot([], [], color="0.5", linestyle=":", label="a multipole method of 2006 pays")
    left.set(xscale="log", yscale="log", xlabel="M, points of a ring", ylabel="ms")
    left.legend(title=f"threads: {count}", fontsize="small")
    for k, name in enumerate(ERROR_SCENES):
        own = [row for row in errors if row["scene"] == name]
        cost = [row["fast"].median for row in own]
        right.loglog(cost, [row["u"] for row in own], marker="o", color=f"C{k}", label=name)
        right.loglog(cost, [row["w"] for row in own], marker="s", color=f"C{k}", linestyle="--")
    exact = min(row["exact"].median for row in errors)
    right.axvline(exact, color="k", linestyle=":", label="exact sum")
    right.set(xlabel=f"a sum over {ERROR_POINTS} points, ms of one thread", ylabel="relative error")
    right.legend(title="u; dashed: w", fontsize="small")


if __name__ == "__main__":
    main()
