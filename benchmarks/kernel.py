"""Nanoseconds per pair of the fused sums, by number of points, threads, blob and variant."""

import click
import numpy as np
from common import (
    Timed,
    benchmark,
    curve,
    interleaved,
    thread_counts,
    threads_option,
)
from tables import Spread, Table

SIZES = (50, 76, 100, 200, 400, 600, 1000, 2000)
QUICK_SIZES = (50, 200, 600)
WALL = -3.0
VARIANTS = {  # planar, angular: arguments of rodsim.flows.by_threads.velocity_kernel
    "spatial": (False, True),
    "no_w": (False, False),
    "planar": (True, True),
}
COLUMNS = {
    "blob": "blob",
    "points": "M",
    "threads": "threads",
    "spatial": "3-D, ns/pair",
    "no_w": "3-D without w, ns/pair",
    "planar": "planar, ns/pair",
    "planar_ratio": "planar / 3-D",
    "no_w_ratio": "without w / with w",
    "speedup": "speed-up, 3-D",
}
WALL_COLUMNS = {
    "blob": "blob",
    "points": "M",
    "threads": "threads",
    "wall_spatial": "wall, 3-D, ns/pair",
    "wall_no_w": "without w, ns/pair",
    "wall_planar": "planar, ns/pair",
    "spatial_over_free": "wall / free, 3-D",
    "no_w_over_free": "wall / free, without w",
    "planar_over_free": "wall / free, planar",
}


@benchmark(full=21, short=5)
@threads_option
@click.option("--points", multiple=True, type=click.IntRange(2), help="M; again for more sizes.")
def main(quick, repeats, threads, points):
    """Measure the sums (32), (33) alone, in free space and above a wall: ns per pair of points.

    All variants run in rounds in one process, and ratios are taken within a round, so that what
    disturbs a round disturbs both sides of its ratios.
    """
    sizes = points or (QUICK_SIZES if quick else SIZES)
    counts = thread_counts(threads)
    keys = [
        (blob, size, count, variant)
        for blob in ("algebraic7", "algebraic9")
        for size in sizes
        for count in counts
        for variant in (*VARIANTS, *(f"wall_{name}" for name in VARIANTS))
    ]
    timers = {key: Timed(call(*key)) for key in keys}
    times = {k: np.array(v) for k, v in interleaved(timers, repeats, "kernels").items()}
    groups = dict.fromkeys(key[:3] for key in keys)
    rows = [row(times, *group) for group in groups]
    tables = [
        Table("The fused sum, per pair of points", COLUMNS, rows),
        Table("Above a wall", WALL_COLUMNS, [wall_row(times, *group) for group in groups]),
    ]
    return tables, lambda *axes: draw(rows, *axes)


def call(blob, size, threads, variant):
    """Return a function that evaluates one sum over ``size`` points of a ring."""
    import numba

    from rodsim.flows.blobs import BLOBS
    from rodsim.flows.by_threads import velocity_kernel

    planar, angular = VARIANTS[variant.removeprefix("wall_")]
    angle = np.arange(size) * (2.0 * np.pi / size)
    points = 2.5 * np.stack([0.0 * angle, np.cos(angle), np.sin(angle)])
    loads = np.random.default_rng(1).standard_normal((6, size))
    epsilon = 4.0 * 2.5 * 2.0 * np.pi / size
    kernel = velocity_kernel(BLOBS[blob], planar, angular, variant.startswith("wall_"))
    out = np.zeros((6 if angular else 3, size))

    def evaluate():
        numba.set_num_threads(threads)
        kernel(points, points, loads, epsilon, 1e-6, WALL, out)

    return evaluate


def row(times, blob, size, threads):
    """Return one row of the table: times over M^2, ratios round by round."""
    seconds = {variant: times[blob, size, threads, variant] for variant in VARIANTS}
    return {
        "blob": blob,
        "points": size,
        "threads": threads,
        **{name: Spread.of(values, 1e9 / size**2) for name, values in seconds.items()},
        "planar_ratio": Spread.of(seconds["planar"] / seconds["spatial"]),
        "no_w_ratio": Spread.of(seconds["no_w"] / seconds["spatial"]),
        "speedup": Spread.of(times[blob, size, 1, "spatial"] / seconds["spatial"]),
    }


def wall_row(times, blob, size, threads):
    """Return one row of the table of sums above a wall, with ratios to those in free space."""
    row = {"blob": blob, "points": size, "threads": threads}
    for name in VARIANTS:
        free, wall = (times[blob, size, threads, prefix + name] for prefix in ("", "wall_"))
        row[f"wall_{name}"] = Spread.of(wall, 1e9 / size**2)
        row[f"{name}_over_free"] = Spread.of(wall / free)
    return row


def draw(rows, left, right):
    """Left: ns per pair against M; right: the ratios, serial."""
    rows = [row for row in rows if row["blob"] == "algebraic7"]
    most = max(row["threads"] for row in rows)
    for number, variant in enumerate(VARIANTS):
        for count in {1, most}:
            chosen = [row for row in rows if row["threads"] == count]
            style = {"color": f"C{number}", "linestyle": "-" if count == 1 else "--"}
            curve(left, chosen, "points", variant, label=f"{variant}, {count}", **style)
    left.set(xscale="log", xlabel="M", ylabel="ns per pair (algebraic7)", ylim=(0, None))
    left.legend(title="variant, threads", fontsize="small")
    chosen = [row for row in rows if row["threads"] == 1]
    for name in ("planar_ratio", "no_w_ratio"):
        curve(right, chosen, "points", name, label=COLUMNS[name])
    right.set(xscale="log", xlabel="M", ylabel="ratio, serial", ylim=(0, 1.2))
    right.legend()
    for axes in (left, right):
        axes.xaxis.set_minor_formatter("")
        axes.set_xticks([row["points"] for row in chosen], [row["points"] for row in chosen])


if __name__ == "__main__":
    main()
