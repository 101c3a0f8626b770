"""Error against run time of every shipped scene, beside forward Euler and RK4.

Each scene is a study in time of ``rodsim converge`` (tolerances two decades around its own, the
longest stable steps of Euler and RK4) with fewer rows: a tolerance a decade, the reference another
decade below. Of scenes that would take longer than ``budget`` seconds it is the first part. Times
are CPU seconds of one thread, one run after another, which other work on the machine changes least.
work_precision.py --all calls it.
"""

import csv
import time
from pathlib import Path

import numpy as np

CONFIGS = Path(__file__).parent.parent / "configs"
AXES = ("tolerance", "step")
RESTS = ("michell_ring",)  # for rodsim rest: nothing of it moves
COLUMNS = ("scene", "end", "of the run", "points", "method", "value", "status", "error / length",
           "reference / length", "evaluations", "seconds", "part run")  # fmt: skip
NEAR = 2.0  # times the error of the reference: below it errors are the same
TEXTS = ("scene", "method", "status")
PARTS = (1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001)  # of a run
DECADES = (1e2, 1e1, 1.0, 1e-1, 1e-2)  # tolerances, over a scene's own
MARKS = {"rkc": "o", "euler": "s", "rk4": "^"}
COLOURS = {"rkc": "#0b4f8a", "euler": "#d1660f", "rk4": "#3a7d2c"}


def scenes():
    """Return the names of the shipped scenes that run."""
    return [path.stem for path in sorted(CONFIGS.glob("*.yaml")) if path.stem not in RESTS]


def rows_of(scene, budget):
    """Return the rows of a scene's study, with the keys of COLUMNS."""
    path = CONFIGS / f"{scene}.yaml"
    part = next((part for part in PARTS if _seconds(path, part) < budget), PARTS[-1])
    return [
        {
            "scene": scene, "end": study.case.time.end, "of the run": part,
            "points": study.scene.rods.points, "method": result.row.method,
            "value": result.row.value, "status": result.status,
            "part run": result.row.part, **_numbers(section, result),
        }
        for study, section, result in _results(path, part)
    ]  # fmt: skip


def _first(path, part, more=()):
    """Return the first part of a scene; frames stay where they were, as far as it goes."""
    from rodsim.case import load_case

    if part == 1.0:
        return load_case(path, more)
    whole = load_case(path)
    end = float(f"{part * whole.time.end:.3g}")
    interval = min(end, whole.output.interval)
    return load_case(path, (f"time.end={end!r}", f"output.interval={interval!r}", *more))


def _results(path, part):
    from rodsim.convergence import outcome, side_by_side
    from rodsim.convergence.study import Study

    outcome.perf_counter = time.thread_time
    side_by_side.usable_cores = lambda: 1
    study = Study(lambda more: _first(path, part, more), AXES, threads=1)
    for section, result in study.run():
        yield study, section, result


def _seconds(path, part):
    """Predict how long the study of the first part of a scene takes."""
    from rodsim.convergence import rows
    from rodsim.convergence.plan import plan
    from rodsim.integrators.limits import stability
    from rodsim.scene.build import build_scene
    from rodsim.scene.system import RodSystem

    rows.TOLERANCES, rows.REFERENCE, rows.CHECK = DECADES, DECADES[-1] / 10.0, DECADES[-1]
    case = _first(path, part)
    scene = build_scene(case)
    stability(RodSystem(scene))  # what is compiled is loaded
    system, begin = RodSystem(scene), time.thread_time()
    limits = stability(system)
    each = (time.thread_time() - begin) / system.evaluations
    (timed,) = plan(case, scene, limits, AXES)
    return each * sum(row.evaluations for row in timed.all_rows)


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


def read(paths):
    """Return the rows of files that ``write`` has made."""
    rows = []
    for path in paths:
        with open(path, newline="") as stream:
            for row in csv.DictReader(stream):
                rows.append(
                    {key: text if key in TEXTS else _number(text) for key, text in row.items()}
                )
    return rows


def _number(text):
    return float(text) if text else None


def table(rows):
    """Yield a line of Markdown for each scene: rkc at its own tolerance, beside Euler and RK4."""
    heads = ["scene", "points", "part", "rkc at its tolerance: error, evaluations, s"]
    heads += [f"{method}: error, evaluations, over rkc" for method in ("euler", "rk4")]
    yield "| " + " | ".join(heads) + " |"
    yield "|---" * len(heads) + "|"
    for scene in sorted(dict.fromkeys(row["scene"] for row in rows)):
        mine = [row for row in rows if row["scene"] == scene]
        done = [row for row in mine if row.get("seconds")]
        own = [row for row in done if row["method"] == "rkc"][len(DECADES) // 2]
        cells = [scene, f"{own['points']:.0f}", f"{own['of the run']:.3g}"]
        cells.append(f"{own['value']:.0e}: {own['error / length']:.0e}, {own['evaluations']:.0f}, "
                     f"{own['seconds']:.2g}")  # fmt: skip
        for method in ("euler", "rk4"):
            row = next(row for row in mine if row["method"] == method)
            cells.append(_beside(row, done) if row.get("seconds") else row["status"])
        yield "| " + " | ".join(cells) + " |"


def _beside(row, done):
    """Say what a method of fixed step comes to, and how much more that is than rkc takes."""
    mark = "*" if row["part run"] < 1.0 else ""
    near = "~" if row["error / length"] < NEAR * (row["reference / length"] or 0.0) else ""
    text = f"{mark}{near}{row['error / length']:.0e}, {row['evaluations']:.0f}"
    rkc = _as_good(row, done)
    if rkc is None:
        return f"{text}, none"
    ratios = (row[key] / rkc[key] for key in ("evaluations", "seconds"))
    return f"{text}, " + " / ".join(f"{r:.1f}" if r < 10.0 else f"{r:.0f}" for r in ratios)


def _as_good(row, others):
    """Return the cheapest row of rkc with no larger an error, or None."""
    enough = max(row["error / length"], NEAR * (row["reference / length"] or 0.0))
    good = [r for r in others if r["method"] == "rkc" and r["error / length"] <= enough]
    return min(good, key=lambda r: r["evaluations"], default=None)


def draw(rows, path):
    """Draw the errors of all scenes over run time and over evaluations; hollow: stretches."""
    from rodsim.plotting import style

    figure = style.new_figure(12, 5.5)
    axes = figure.subplots(1, 2, sharey=True)
    for axis, cost in zip(axes, ("seconds", "evaluations"), strict=True):
        for scene in dict.fromkeys(row["scene"] for row in rows):
            for method in MARKS:
                mine = [r for r in rows if (r["scene"], r["method"]) == (scene, method)]
                _draw_line(axis, method, cost, [r for r in mine if r.get("error / length")])
        for method, marker in MARKS.items():
            axis.plot([], [], marker=marker, c=COLOURS[method], label=method)
        axis.plot([], [], "s", mfc="white", c="0.4", label="only a first part was run")
        axis.set_xlabel("CPU time of the solve (s)" if cost == "seconds" else cost)
        axis.grid(which="major", color="0.9")
        axis.set_axisbelow(True)
    style.legend_above(axes[0])
    axes[0].set_ylabel("largest position error at the end, over the longest rod")
    style.save(figure, path, dpi=110)


def _draw_line(axis, method, cost, rows):
    if not rows:
        return
    x, y = np.transpose([(row[cost], row["error / length"]) for row in rows])
    marker, colour = MARKS[method], COLOURS[method]
    axis.loglog(x, y, marker=marker, ms=4, lw=0.8, c=colour, alpha=0.7)
    hollow = [row["part run"] < 1.0 for row in rows]
    axis.plot(x[hollow], y[hollow], marker, ms=4, mfc="white", c=colour)


def main(names, budget, out, paths):
    """Study the scenes one by one and write OUT.csv as they end, or read such files; then the
    table and OUT.png."""
    rows = read(paths)
    for scene in [] if paths else names or scenes():
        rows += rows_of(scene, budget)
        write(f"{out}.csv", rows)
        print(f"{scene}: {len([r for r in rows if r['scene'] == scene])} rows", flush=True)
    if paths:
        write(f"{out}.csv", rows)
    print("\n".join(table(rows)))
    draw(rows, f"{out}.png")
