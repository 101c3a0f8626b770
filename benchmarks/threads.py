"""Does a run choose its threads well? Sums and solves on every number of threads."""

from common import (
    CONFIGS,
    Timed,
    benchmark,
    curve,
    interleaved,
    thread_counts,
    threads_option,
)
from pieces import sum_of
from speedup import Solve, shorter
from tables import Spread, Table

SIZES = (50, 76, 100, 140, 200, 280, 400, 600, 1000, 2000)
FEW = (76, 200, 600, 2000)
SCENES = ("closed_ring", "flagellum")
COLUMNS = {
    "what": "of",
    "points": "M",
    "threads": "threads",
    "chosen": "chosen",
    "time": "time, us",
    "gain": "over serial",
    "ahead": "over the best of fewer",
    "verdict": "",
}


@benchmark(full=25, short=5)
@threads_option
def main(quick, repeats, threads):
    """Measure the sum of a ring of M points, and solves of two scenes, on each number of threads.

    Solves are cut to a tenth of their time. What a run chooses is right where no smaller number is
    faster: "slower than fewer" says that it was in three rounds of four or more.
    """
    counts = thread_counts(threads)
    sums = [row for size in (FEW if quick else SIZES) for row in of_sum(size, counts, repeats)]
    solves = [row for name in SCENES for row in of_solve(name, counts, repeats)]
    named = {"Threads of a sum": sums, "Threads of a solve": solves}
    tables = [Table(name, COLUMNS, found) for name, found in named.items()]
    return [*tables, summary(sums + solves)], lambda *axes: draw(sums, *axes)


def chosen_for(case, scene):
    """Return the number of threads that a run of a scene takes."""
    import numba

    from rodsim.run.machine import Machine

    with Machine(case, scene, force=True).threads(None):
        return numba.get_num_threads()


def of_sum(size, counts, repeats):
    """Return the rows of a ring of ``size`` points."""
    from rodsim.case import load_case
    from rodsim.scene.build import build_scene

    case = load_case(CONFIGS / "closed_ring.yaml", [f"rods.ring.shape.points={size}"])
    scene = build_scene(case)
    chosen = chosen_for(case, scene)
    counts = sorted({*counts, chosen})
    sums = {count: Timed(sum_of(scene, count)) for count in counts}
    return rows(interleaved(sums, repeats, f"M = {size}"), "sum", size, chosen)


def of_solve(name, counts, repeats):
    """Return the rows of a scene solved in memory."""
    solve = Solve(name, 1, *shorter(name, True))
    chosen = chosen_for(solve.case, solve.scene)
    solves = {n: (lambda n=n: solve.on(n)["wall"]) for n in sorted({*counts, chosen})}
    return rows(interleaved(solves, repeats, name), name, solve.scene.rods.points, chosen)


def rows(results, what, size, chosen):
    """Return a row for each number of threads; ratios are taken round by round."""
    found = []
    for count, own in results.items():
        fewer = [results[n] for n in results if n < count]
        rounds = zip(own, zip(*fewer, strict=True), strict=True) if fewer else ()
        ahead = [min(before) / mine for mine, before in rounds]
        gain = [one / mine for one, mine in zip(results[1], own, strict=True)]
        found.append(
            {
                "what": what,
                "points": size,
                "threads": count,
                "chosen": "yes" if count == chosen else "",
                "time": Spread.of(own, 1e6),
                "gain": Spread.of(gain),
                "ahead": Spread.of(ahead) if ahead else None,
            }
        )
    return found


def summary(found):
    """Return the chosen rows, each with what is to be said of it."""
    own = [dict(row) for row in found if row["chosen"]]
    for row in own:
        alike = [r for r in found if (r["what"], r["points"]) == (row["what"], row["points"])]
        best = max(alike, key=lambda r: r["gain"].median)
        slower = row["ahead"] and row["ahead"].high < 1.0
        row["verdict"] = "slower than fewer" if slower else "not slower than fewer"
        row["verdict"] += f"; best: {best['gain'].median:.3g} on {best['threads']}"
    return Table("What is chosen", COLUMNS, own)


def draw(rows, left, right):
    """Left: the speed-up against M; right: that of the chosen number."""
    for count in sorted({row["threads"] for row in rows}):
        curve(left, [r for r in rows if r["threads"] == count], "points", "gain", label=str(count))
    curve(right, [row for row in rows if row["chosen"]], "points", "gain")
    for axes in (left, right):
        axes.set(xscale="log", xlabel="M", ylabel="over serial")
    left.legend(title="threads", fontsize="small")


if __name__ == "__main__":
    main()
