"""Errors of the three scenes apart: in time, in the spacing, in epsilon, in both; both blobs.

    python benchmarks/error_analysis.py [--scene NAME]... [--blob NAME]... [-o FOLDER]

The tables and pictures of docs/error-analysis.md. For every scene and blob it runs a grid of
spacings (the number of segments doubled twice) and epsilons (0.18 to 2 times the
case's), and the tolerances and steps of ``rodsim converge``. What is compared: the shape at the
end, by its largest difference over the rod's length; for the flagellum also the speed.
"""

import csv
import sys
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import click
import numpy as np
from common import CONFIGS

from rodsim.compiled.settings import prepare

SCENES = ("open_rod", "closed_ring", "flagellum")
BLOBS = ("algebraic7", "algebraic9")
SPACINGS = {  # factors on the number of segments: three levels, each twice the one before
    "open_rod": (1.0, 2.0, 4.0),  # 75 segments cannot be halved
    "closed_ring": (0.5, 1.0, 2.0),
    "flagellum": (0.5, 1.0, 2.0),
}
EPSILONS = (0.18, 0.25, 0.35, 0.5, 0.71, 1.0, 1.41, 2.0)  # factors on the case's epsilon
TOLERANCE = 1e-6
# The flagellum for three periods, with one point more: 599 segments cannot be halved.
CHANGES = {"flagellum": ("time.end=0.0471238898038469", "rods.tail.shape.points=601")}


@dataclass(frozen=True)
class Grid:
    """The outcomes of a scene and blob by (factor on segments, factor on epsilon)."""

    scene: str
    blob: str
    spacings: float  # the case's epsilon in its spacing
    runs: dict

    def gap(self, one, other):
        """Largest difference of two runs at shared points over the length, and of speeds."""
        from rodsim.convergence.outcome import compare

        if self.runs[one] is None or self.runs[other] is None:
            return None
        return compare(self.runs[one], self.runs[other])


def load(scene, overrides):
    from rodsim.case import load_case

    return load_case(CONFIGS / f"{scene}.yaml", (*CHANGES.get(scene, ()), *overrides))


def run_grid(scene, blob, bar) -> Grid:
    """Run every spacing at every epsilon."""
    from rodsim.convergence.outcome import solve
    from rodsim.convergence.rows import quiet, refine, rkc
    from rodsim.errors import RodsimError
    from rodsim.scene.build import build_scene

    case = load(scene, ())
    start = build_scene(case)
    runs = {}
    for f, e in product(SPACINGS[scene], EPSILONS):
        keys = (*quiet(case), *rkc(TOLERANCE), f"fluid.blob={blob}",
                f"fluid.epsilon={e * start.epsilon!r}")  # fmt: skip
        try:
            runs[f, e] = solve(load(scene, (*refine(case, f), *keys)))
        except RodsimError as error:
            click.echo(f"{scene} {blob} {f} {e}: {error}", err=True)
            runs[f, e] = None
        bar.update(1)
    return Grid(scene, blob, start.epsilon / start.rods.spacing[0], runs)


def spacing_rows(grid: Grid):
    """Yield the error of the discretisation at each epsilon: order seen, error at the case's ds.

    With an error C ds^p the differences of three runs give p; the error at the case's own spacing
    is 4/3 of the difference from half of it (p = 2).
    """
    low, middle, high = SPACINGS[grid.scene]
    for e in EPSILONS:
        coarse, fine = grid.gap((low, e), (middle, e)), grid.gap((middle, e), (high, e))
        own = grid.gap((1.0, e), (2.0, e))
        if own is None:
            continue
        order = np.log2(coarse.relative / fine.relative) if coarse and fine else None
        yield {
            "scene": grid.scene, "blob": grid.blob, "epsilon / ds": e * grid.spacings,
            "error / length": 4 / 3 * own.relative,
            "speed error": None if own.speed is None else 4 / 3 * own.speed,
            "order": order,
            "evaluations": grid.runs[1.0, e].evaluations,
        }  # fmt: skip


def epsilon_rows(grid: Grid):
    """Yield what epsilon changes, at the finest spacing, against the case's own epsilon."""
    for e in EPSILONS:
        gap = grid.gap((2.0, e), (2.0, 1.0))
        if gap is None:
            continue
        yield {
            "scene": grid.scene, "blob": grid.blob, "epsilon / the case's": e,
            "difference / length": gap.relative,
            "speed": _signed_speed(grid, (2.0, e)),
        }  # fmt: skip


def together_rows(grid: Grid):
    """Yield what happens where epsilon shrinks with ds: no convergence, another model each time."""
    for f, e in ((0.5, 2.0), (1.0, 1.0), (2.0, 0.5)):
        if (f, e) not in grid.runs:
            continue
        after = (2 * f, e / 2)
        gap = grid.gap((f, e), after) if after in grid.runs else None
        at_fixed = grid.gap((f, e), (2 * f, e)) if (2 * f, e) in grid.runs else None
        if grid.runs[f, e] is None:
            continue
        yield {
            "scene": grid.scene, "blob": grid.blob, "segments / the case's": f,
            "epsilon / the case's": e,
            "both halved: difference / length": gap and gap.relative,
            "ds halved: difference / length": at_fixed and at_fixed.relative,
            "speed": _signed_speed(grid, (f, e)),
        }  # fmt: skip


def _signed_speed(grid, key):
    run = grid.runs[key]
    return float(run.velocity[2]) if run.scene.parts.driven else None


def time_rows(scene, blob):
    """Yield the rows of ``rodsim converge --in tolerance,step``."""
    from rodsim.convergence.study import Study

    study = Study(lambda more: load(scene, (f"fluid.blob={blob}", *more)), ("tolerance", "step"))
    for section, result in study.run():
        if result.errors is None:
            continue
        yield {
            "scene": scene, "blob": blob, "method": result.row.method, "value": result.row.value,
            "error / length": result.errors.relative, "speed error": result.errors.speed,
            "evaluations": result.outcome.evaluations, "steps": result.outcome.steps,
            "reference / length": section.own.relative,
        }  # fmt: skip


def write(path, rows):
    """Write rows as CSV; nothing where there are none."""
    rows = list(rows)
    if rows:
        with path.open("w", newline="") as stream:
            out = csv.DictWriter(stream, list(rows[0]))
            out.writeheader()
            out.writerows(rows)
    return rows


STYLES = {"open_rod": ("o", "#0b4f8a"), "closed_ring": ("s", "#d1660f"),
          "flagellum": ("^", "#3a7d2c")}  # fmt: skip
DASHES = {"algebraic7": "-", "algebraic9": "--"}


def draw(folder, scenes, blobs):
    """Draw error-space.png and error-time.png from the tables in a folder."""
    from matplotlib.figure import Figure

    space, time = (Figure(figsize=(11, 4.6), layout="constrained") for _ in range(2))
    left, right = space.subplots(1, 2)
    table = "spacing", "epsilon / ds", "error / length"
    _lines(left, folder, scenes, blobs, *table)
    left.set(xlabel="epsilon / ds", ylabel="error of the spacing, over the rod's length")
    left.axhline(0.01, c="0.6", lw=1)
    left.set_ylim(top=0.5)  # room for the legend, which serves both
    table = "epsilon", "epsilon / the case's", "difference / length"
    _lines(right, folder, scenes, blobs, *table)
    right.set(xlabel="epsilon / the case's", ylabel="difference from the case, over the length")
    right.set_xticks((0.2, 0.5, 1.0, 2.0), ("0.2", "0.5", "1", "2"))
    right.set_xticks((), minor=True)
    right.get_legend().remove()
    left, right = time.subplots(1, 2)
    for axis, column in ((left, "evaluations"), (right, "steps")):
        for method, fill in (("rkc", "full"), ("euler", "none")):
            table = "time", column, "error / length"
            _lines(axis, folder, scenes, blobs[:1], *table, method=method, fillstyle=fill)
        axis.set(xlabel=column, ylabel="error in time, over the rod's length")
    for figure, name in ((space, "space"), (time, "time")):
        figure.savefig(folder / f"error-{name}.png", dpi=100)


def _lines(axis, folder, scenes, blobs, name, x, y, method=None, **style):
    for scene, blob in product(scenes, blobs):
        path = folder / f"{name}-{scene}-{blob}.csv"
        with path.open() as stream:
            rows = [r for r in csv.DictReader(stream) if method in (None, r.get("method"))]
        points = sorted((float(r[x]), float(r[y])) for r in rows if float(r[y] or 0) > 0)
        marker, colour = STYLES[scene]
        label = f"{scene}, {method or blob}"
        axis.loglog(*zip(*points, strict=True), DASHES[blob], marker=marker, c=colour,
                    label=label, **style)  # fmt: skip
    axis.grid(color="0.9")
    axis.legend(frameon=False, fontsize=8)


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.option("--scene", "scenes", multiple=True, type=click.Choice(SCENES), default=SCENES)
@click.option("--blob", "blobs", multiple=True, type=click.Choice(BLOBS), default=BLOBS)
@click.option(
    "-o",
    "folder",
    type=click.Path(path_type=Path, file_okay=False),
    default="error-analysis",
    show_default=True,
    help="Where tables and pictures go.",
)
def main(scenes, blobs, folder):
    """Errors of the three scenes apart: in time, spacing, epsilon and both; both blobs."""
    prepare()
    folder.mkdir(parents=True, exist_ok=True)
    total = len(scenes) * len(blobs) * 3 * len(EPSILONS)
    grids = []
    with click.progressbar(length=total, label="grid", file=sys.stderr) as bar:
        for scene, blob in product(scenes, blobs):
            grids.append(run_grid(scene, blob, bar))
            for name, rows in (("spacing", spacing_rows), ("epsilon", epsilon_rows),
                               ("together", together_rows)):  # fmt: skip
                write(folder / f"{name}-{scene}-{blob}.csv", rows(grids[-1]))
    for scene, blob in product(scenes, blobs):
        write(folder / f"time-{scene}-{blob}.csv", time_rows(scene, blob))
    draw(folder, scenes, blobs)


if __name__ == "__main__":
    main()
