"""Cost of one evaluation, and memory, against the number of points."""

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
from pieces import elasticity_of, sum_of
from tables import Spread, Table

SIZES = (50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000, 50_000, 100_000)
QUICK_LARGEST = 5000
COLUMNS = {
    "points": "M",
    "threads": "threads",
    "elastic": "elasticity alone, ms",
    "sum": "sum alone, ms",
    "whole": "evaluation, ms",
    "pair": "sum, ns/pair",
    "repeats": "repeats",
    "build": "case and scene, ms",
    "memory": "memory, kB",
    "per_point": "bytes per point",
    "note": "note",
}


@benchmark(full=15, short=5)
@threads_option
@click.option("--points", multiple=True, type=click.IntRange(8), help="M; again for more sizes.")
@click.option("--budget", type=click.FloatRange(0, min_open=True), default=90.0, show_default=True,
              help="Seconds that one size may take; what needs more is skipped.")  # fmt: skip
def main(quick, repeats, threads, points, budget):
    """Measure one evaluation of a ring of M points: elasticity, sum, and the memory it needs.

    The time is foreseen from the size before: repeats are cut to fit the budget, and a size of
    which a single evaluation does not fit is skipped. Memory is what the arrays of the case, the
    scene, the system and one pair of increment vectors take, as NumPy counts it.
    """
    largest = QUICK_LARGEST if quick else SIZES[-1]
    counts = thread_counts(threads)
    rows, pair_seconds = [], 0.0
    for size in sorted(points) or [size for size in SIZES if size <= largest]:
        foreseen = 2 * pair_seconds * size**2 * len(counts)  # the sum, and the whole
        fit = repeats if foreseen == 0.0 else min(repeats, int(budget / foreseen) - 1)
        if foreseen > budget:
            rows.append({"points": size, "note": f"skipped: about {foreseen:.0f} s"})
            continue
        new = measure(size, counts, max(1, fit))
        pair_seconds = max(row["pair"].median for row in new) * 1e-9
        rows += new
    table = Table("One evaluation", COLUMNS, rows)
    return [table], lambda *axes: draw([row for row in rows if "sum" in row], *axes)


def measure(size, counts, repeats):
    """Return the rows of one size, one for each number of threads."""
    evaluations = {count: Evaluation(size, count) for count in counts}
    results = interleaved(evaluations, repeats, f"M = {size}")
    rows = []
    for count, parts in results.items():
        elastic, total, wall = zip(*parts, strict=True)
        spent = evaluations[count]
        rows.append(
            {
                "points": size,
                "threads": count,
                "elastic": Spread.of(elastic, 1e3),
                "sum": Spread.of(total, 1e3),
                "whole": Spread.of(wall, 1e3),
                "pair": Spread.of(total, 1e9 / size**2),
                "repeats": repeats,
                "build": 1e3 * spent.build_seconds,
                "memory": spent.memory / 1024,
                "per_point": spent.memory / size,
            }
        )
    return rows


class Evaluation:
    """Call it for (elasticity, sum, wall) seconds of one evaluation, each timed alone."""

    def __init__(self, size, threads):
        import numba

        self.size = size
        self._build()  # imports and compiles
        tracemalloc.start()
        self._build()
        self.memory, _ = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        begin = time.perf_counter()
        self._build()
        self.build_seconds = time.perf_counter() - begin
        scene, system, state = self.system.scene, self.system, self.system.scene.initial

        def whole():
            numba.set_num_threads(threads)
            system.rate(0.0, state, self.increments, self.rates)

        pieces = elasticity_of(scene), sum_of(scene, threads), whole
        self.pieces = [self._timed(piece) for piece in pieces]

    def _timed(self, piece):
        return Timed(piece) if self.size <= 10_000 else functools.partial(_once, piece)

    def _build(self):
        from rodsim.case import load_case
        from rodsim.scene.build import build_scene
        from rodsim.scene.system import RodSystem

        change = f"rods.ring.shape.points={self.size}"
        case = load_case(CONFIGS / "closed_ring.yaml", [change])
        self.system = RodSystem(build_scene(case))
        self.increments, self.rates = self.system.zeros(), self.system.zeros()

    def __call__(self):
        return [piece() for piece in self.pieces]


def _once(call):
    """Seconds of one call without warming up, which would not show at large sizes."""
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


def draw(rows, left, right):
    """Left: elasticity and sum against M; right: memory against M."""
    for count in sorted({row["threads"] for row in rows}):
        chosen = [row for row in rows if row["threads"] == count]
        line = "-" if count == 1 else "--"
        for key, part, color in (("sum", "sum", "C0"), ("elastic", "elasticity", "C1")):
            style = {"label": f"{part}, {count}", "linestyle": line, "color": color}
            curve(left, chosen, "points", key, **style)
    left.set(xscale="log", yscale="log", xlabel="M", ylabel="an evaluation, ms")
    left.legend(title="part, threads", fontsize="small")
    memory = {row["points"]: row["memory"] for row in rows}
    right.loglog(list(memory), list(memory.values()), marker="o")
    right.set(xlabel="M", ylabel="memory of scene and system, kB")


if __name__ == "__main__":
    main()
