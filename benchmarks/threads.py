"""Does a run choose its threads well? The sum of a ring on every number of threads."""

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
from tables import Spread, Table

SIZES = (50, 76, 100, 140, 200, 280, 400, 600, 1000, 2000)
COLUMNS = {
    "points": "M",
    "threads": "threads",
    "chosen": "chosen",
    "sum": "sum, us",
    "gain": "over serial",
    "ahead": "over the best of fewer",
}


@benchmark(full=25, short=5)
@threads_option
def main(quick, repeats, threads):
    """Measure the sum of a ring of M points on each number of threads, and on the chosen one.

    What a run chooses is right where no smaller number is faster: the last column of the chosen
    rows is not below 1, but for the spread.
    """
    import numba

    from rodsim.compiled.threads import threads_for

    rows = []
    for size in SIZES[::3] if quick else SIZES:
        with threads_for(size**2):
            chosen = numba.get_num_threads()
        rows += measure(size, sorted({*thread_counts(threads), chosen}), chosen, repeats)
    return [Table("Threads of a sum", COLUMNS, rows)], lambda *axes: draw(rows, *axes)


def measure(size, counts, chosen, repeats):
    """Return the rows of one size; ratios are taken round by round."""
    from rodsim.case import load_case
    from rodsim.scene.build import build_scene

    case = load_case(CONFIGS / "closed_ring.yaml", [f"rods.ring.shape.points={size}"])
    scene = build_scene(case)
    sums = {count: Timed(sum_of(scene, count)) for count in counts}
    results = interleaved(sums, repeats, f"M = {size}")
    rows = []
    for count in counts:
        fewer = [results[n] for n in counts if n < count]
        rounds = zip(results[count], zip(*fewer, strict=True), strict=True) if fewer else ()
        ahead = [min(before) / own for own, before in rounds]
        gain = [one / own for one, own in zip(results[1], results[count], strict=True)]
        rows.append(
            {
                "points": size,
                "threads": count,
                "chosen": "yes" if count == chosen else "",
                "sum": Spread.of(results[count], 1e6),
                "gain": Spread.of(gain),
                "ahead": Spread.of(ahead) if ahead else None,
            }
        )
    return rows


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
