"""Error against run time of every shipped scene, beside forward Euler and RK4.

Each scene is a study in time of ``rodsim converge`` (tolerances two decades around its own, the
longest stable steps of Euler and RK4), of its first part where all of it would take longer than
``budget`` seconds: the methods of fixed step are what takes long. work_precision.py --all calls it.
"""

import csv
from pathlib import Path

import numpy as np

CONFIGS = Path(__file__).parent.parent / "configs"
AXES = ("tolerance", "step")
RESTS = ("michell_ring",)  # for rodsim rest: nothing of it moves
COLUMNS = ("scene", "end", "of the run", "points", "method", "value", "status", "error / length",
           "reference / length", "evaluations", "seconds")  # fmt: skip
EVALUATION = 7.5e-5  # s that all but the sums takes, on one core
MARKS = {"rkc": "o", "euler": "s", "rk4": "^"}
COLOURS = {"rkc": "#0b4f8a", "euler": "#d1660f", "rk4": "#3a7d2c"}


def scenes():
    """Return the names of the shipped scenes that run."""
    return [path.stem for path in sorted(CONFIGS.glob("*.yaml")) if path.stem not in RESTS]


def rows_of(scene, budget):
    """Return the rows of a scene's study, with the keys of COLUMNS."""
    from rodsim.case import load_case

    path = CONFIGS / f"{scene}.yaml"
    whole = load_case(path)
    end = min(1.0, budget / _seconds(whole)) * whole.time.end
    end = whole.time.end if end == whole.time.end else float(f"{end:.1e}")
    return [
        {
            "scene": scene, "end": end, "of the run": end / whole.time.end,
            "points": study.scene.rods.points, "method": result.row.method,
            "value": result.row.value, "status": result.status, **_numbers(section, result),
        }
        for study, section, result in _results(path, end)
    ]  # fmt: skip


def _results(path, end):
    from rodsim.case import load_case
    from rodsim.convergence.study import Study

    study = Study(lambda more: load_case(path, (f"time.end={end!r}", *more)), AXES)
    for section, result in study.run():
        yield study, section, result


def _seconds(case):
    """Predict how long the rows of fixed step would take."""
    from rodsim.convergence.outcome import pairs
    from rodsim.convergence.rows import step_rows
    from rodsim.integrators.limits import stability
    from rodsim.scene.build import build_scene
    from rodsim.scene.system import RodSystem

    scene = build_scene(case)
    evaluations = sum(row.evaluations for row in step_rows(case, stability(RodSystem(scene))))
    return evaluations * (EVALUATION + 1.5e-9 * pairs(scene))


def _numbers(section, result):
    if result.errors is None:
        return {}
    return {
        "error / length": result.errors.relative,
        "reference / length": section.own.relative if section.own else None,
        "evaluations": result.outcome.evaluations,
        "seconds": result.outcome.best,
    }


def write(path, rows):
    """Write all rows as CSV."""
    with open(path, "w", newline="") as stream:
        out = csv.DictWriter(stream, COLUMNS)
        out.writeheader()
        out.writerows(rows)


def table(rows):
    """Yield a line of Markdown for each scene: Euler and RK4 beside the cheapest rkc as good."""
    heads = ("scene", "points", "time", "method", "error / length", "evaluations",
             "over rkc, as good", "solve/s", "over rkc")  # fmt: skip
    yield "| " + " | ".join(heads) + " |"
    yield "|---" * len(heads) + "|"
    for scene in dict.fromkeys(row["scene"] for row in rows):
        mine = [row for row in rows if row["scene"] == scene and row.get("seconds")]
        for row in (row for row in mine if row["method"] != "rkc"):
            yield "| " + " | ".join(_cells(row, _as_good(row, mine))) + " |"


def _as_good(row, others):
    """Return the cheapest row of rkc with no larger an error, or None."""
    good = [r for r in others if r["method"] == "rkc" and r["error / length"] <= _floor(row)]
    return min(good, key=lambda r: r["evaluations"], default=None)


def _floor(row):
    """Return a row's error, or what the reference may err where that is more."""
    return max(row["error / length"], row["reference / length"] or 0.0)


def _cells(row, rkc):
    part = "" if row["of the run"] == 1.0 else f" ({row['of the run']:.2g} of it)"
    yield from (row["scene"], str(row["points"]), f"{row['end']:.3g}{part}")
    yield from (f"{row['method']} {row['value']:.2g}", f"{row['error / length']:.1e}")
    for key, form in (("evaluations", ".0f"), ("seconds", ".2f")):
        yield f"{row[key]:{form}}"
        yield "none" if rkc is None else f"{row[key] / rkc[key]:.3g}"


def draw(rows, path):
    """Draw the errors of all scenes over run time and over evaluations."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12, 5.5), layout="constrained")
    for axis, cost in zip(
        figure.subplots(1, 2, sharey=True), ("seconds", "evaluations"), strict=True
    ):
        for scene in dict.fromkeys(row["scene"] for row in rows):
            for method, marker in MARKS.items():
                mine = [r for r in rows if (r["scene"], r["method"]) == (scene, method)]
                points = [(r[cost], r["error / length"]) for r in mine if r.get("error / length")]
                if points:
                    axis.loglog(*np.transpose(points), marker=marker, ms=4, lw=0.8,
                                c=COLOURS[method], alpha=0.7)  # fmt: skip
        for method, marker in MARKS.items():
            axis.plot([], [], marker=marker, c=COLOURS[method], label=method)
        axis.set_xlabel("solve (s)" if cost == "seconds" else cost)
        axis.grid(which="major", color="0.9")
        axis.legend(frameon=False)
    figure.axes[0].set_ylabel("largest position error at the end, over the longest rod")
    figure.savefig(path, dpi=110)


def main(names, budget, out):
    """Study the scenes one by one; write OUT.csv as they end, then the table and OUT.png."""
    rows = []
    for scene in names or scenes():
        rows += rows_of(scene, budget)
        write(f"{out}.csv", rows)
        print(f"{scene}: {len([r for r in rows if r['scene'] == scene])} rows", flush=True)
    print("\n".join(table(rows)))
    draw(rows, f"{out}.png")
