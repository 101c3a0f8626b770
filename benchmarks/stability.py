"""Stiff and extreme scenes: how every method ends, how wrong it is, what it costs.

    python benchmarks/stability.py [--group NAME]... [--method NAME]...

Each cell says: the error at the end over the rod's length and the evaluations; or "refused"
before the run; or "stopped", by name, during it. Runs go through ``rodsim.simulate`` into a file,
whose frames must all be finite. The error is that against rkc at 1e-4 of the scene's tolerance.
euler and rk4 take 0.9 of their longest stable step; where that is more than --most evaluations,
they run that many, and the cell gives what the whole run would cost.
"""

import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import click
import numpy as np
from common import benchmark
from extremes import SCENES
from tables import Table

from rodsim.case.methods import METHODS
from rodsim.run.listener import Listener, Summary

SHARE = 0.9  # of the longest stable step
MOST_SECONDS = 300.0
MOST_PAIRS = 2e9  # of large scenes, euler and rk4 run a shorter stretch
TIGHTER = 1e-4
FRAMES = 4


@dataclass(frozen=True)
class Cell:
    """How a run ended: ``finished``, ``refused`` or ``stopped``, and why.

    error: over the rod's length, against the reference; None where there is none, or where the
    run was a stretch only. evaluations: of the whole run, made or (stretch) to be made.
    """

    status: str
    why: str = ""
    error: float | None = None
    evaluations: int = 0
    stretch: bool = False
    seconds: float = 0.0

    def __str__(self):
        if self.status != "finished":
            return f"{self.status}: {self.why}"
        cost = f"{self.evaluations:.3g}" if self.evaluations >= 1e5 else f"{self.evaluations}"
        error = "stable" if self.error is None else f"{self.error:.0e}"
        return f"{error}, {cost}" + (" (stretch)" if self.stretch else "")


class TooLong(Exception):
    """A run has not ended in MOST_SECONDS, of CPU time: others on the machine change that least."""


class Clock(Listener):
    """Stops a run that hangs; keeps how it ended."""

    def __init__(self, patience: float):
        self.end = process_time() + patience
        self.summary = Summary()

    def update(self, fraction, note):
        if process_time() > self.end:
            raise TooLong

    def warn(self, text):
        pass

    def ended(self, summary):
        self.summary = summary


def run(case, folder: Path, patience=MOST_SECONDS, **time):
    """Run a case as the command would; return (last position, summary, or the error)."""
    from rodsim.case import case_from_mapping
    from rodsim.errors import RodsimError
    from rodsim.output import open_trajectory
    from rodsim.run.simulate import simulate

    case = dict(case)
    table = case.pop("table", None)
    if table is not None:
        np.savetxt(folder / "rod.txt", table, fmt="%.17g")
    case["time"] = {**case["time"], **time}
    step = case["time"].get("step")
    count = round(case["time"]["end"] / step) if step else FRAMES
    case["output"] = {"interval": -(-count // FRAMES) * (step or case["time"]["end"] / FRAMES)}
    clock, output = Clock(patience), folder / "out.h5"
    try:
        made = case_from_mapping(case, path=str(folder / "case.yaml"))
        simulate(made, output, overwrite=True, listener=clock)
        failure = None
    except (RodsimError, TooLong) as error:
        failure = error
    summary = clock.summary
    if summary.status == "running":
        return None, summary, failure
    with open_trajectory(output) as result:
        position = result.position
    if not np.isfinite(position).all():
        raise AssertionError("a committed frame is not finite")
    return position[-1], summary, failure


def cell(position, summary, failure, reference, length) -> Cell:
    """Return what a run has come to."""
    from rodsim.errors import DivergedError

    if isinstance(failure, TooLong):
        return Cell("stopped", f"after {MOST_SECONDS:.0f} s, t too far away")
    if isinstance(failure, DivergedError):
        return Cell("stopped", _short(failure))
    if failure is not None:
        return Cell("refused", _short(failure))
    error = None
    if reference is not None:
        error = float(np.linalg.norm(position - reference, axis=1).max() / length)
    cost = summary.runtime
    return Cell("finished", error=error, evaluations=cost["evaluations"],
                seconds=cost["solve_seconds"])  # fmt: skip


def _short(error):
    problems = getattr(error, "problems", None)
    text = problems[0].reason if problems else str(error).splitlines()[0]
    return text if len(text) < 110 else text[:107] + "..."


def fixed_step(case, method, limit, most, patience, folder, reference, length) -> Cell:
    """Run euler or rk4 at 0.9 of its limit, whole or a stretch of ``most`` evaluations."""
    end, steps = case["time"]["end"], int(np.ceil(case["time"]["end"] / (SHARE * limit)))
    stretch = METHODS[method].stages * steps > most
    step = end / steps
    count = most // METHODS[method].stages if stretch else steps
    settings = {"integrator": method, "step": step, "end": step * count}
    done = cell(*run(case, folder, patience, **settings), None if stretch else reference, length)
    if done.status == "finished" and stretch:
        return Cell("finished", evaluations=METHODS[method].stages * steps, stretch=True)
    return done


def measure(case, methods, most, patience=MOST_SECONDS) -> dict:
    """Return a cell for each method, and the fastest rate of the scene.

    patience : seconds after which a run is stopped.
    """
    from rodsim.case import case_from_mapping
    from rodsim.errors import RodsimError
    from rodsim.integrators.limits import stability
    from rodsim.scene.build import build_scene
    from rodsim.scene.system import RodSystem

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        tolerance = case["time"]["tolerance"]
        reference, _, failure = run(
            case, folder, patience, tolerance=max(1e-12, TIGHTER * tolerance)
        )
        reference = None if failure else reference
        plain = {key: value for key, value in case.items() if key != "table"}
        try:
            scene = build_scene(case_from_mapping(plain, path=str(folder / "case.yaml")))
        except RodsimError as error:
            return {"rate": None} | dict.fromkeys(methods, Cell("refused", _short(error)))
        length, limits = scene.length_scale, stability(RodSystem(scene))
        cells = {"rate": limits.rate}
        for method in methods:
            if METHODS[method].adaptive:
                cells[method] = cell(*run(case, folder, patience), reference, length)
            else:
                limit = limits.largest_steps[method]
                few = min(most, max(100, int(MOST_PAIRS / scene.rods.points**2)))
                cells[method] = fixed_step(
                    case, method, limit, few, patience, folder, reference, length
                )
        return cells


@benchmark(full=1, short=1)
@click.option(
    "--group",
    "groups",
    multiple=True,
    type=click.Choice(list(SCENES)),
    help="Only these groups of scenes.",
)
@click.option(
    "--method", "methods", multiple=True, type=click.Choice(METHODS), help="Only these methods."
)
@click.option(
    "--most",
    default=20_000,
    show_default=True,
    type=click.IntRange(100),
    help="Evaluations of euler and rk4 after which a stretch must do.",
)
def main(quick, repeats, groups, methods, most):
    """How every method ends in stiff and extreme scenes, how wrong it is and what it costs."""
    methods = methods or METHODS
    if quick:
        most = 1000
    rows = []
    names = [(group, name) for group in groups or SCENES for name in SCENES[group]]
    with click.progressbar(names, label="scenes", file=sys.stderr) as bar:
        for group, name in bar:
            found = measure(SCENES[group][name], methods, most)
            rows.append({"group": group, "scene": name, **found})
    shown = [
        {"group": r["group"], "scene": r["scene"], "rate": r["rate"] or "",
         **{m: str(r[m]) for m in methods}, **{f"{m}_seconds": r[m].seconds for m in methods}}
        for r in rows
    ]  # fmt: skip
    columns = {"group": "group", "scene": "scene", "rate": "fastest rate"}
    columns |= {m: f"{m}: error / length, evaluations" for m in methods}
    return [Table("Stiff and extreme scenes", columns, shown)], lambda *axes: draw(rows, *axes)


COLOURS = {"rkc": "#0b4f8a", "euler": "#d1660f", "rk4": "#3a7d2c"}
MARKERS = {"rkc": "o", "euler": "s", "rk4": "^"}


def draw(rows, left, right):
    """Evaluations against stiffness (all moduli together), and against epsilon."""
    for axis, group, label in (
        (left, "moduli, all", "all moduli, over the paper's"),
        (right, "epsilon, spacings", "epsilon, in spacings"),
    ):
        for method in METHODS:
            points = [
                (float(r["scene"].replace("x ", "")), r[method].evaluations)
                for r in rows
                if r["group"] == group and method in r and r[method].status == "finished"
            ]
            if len(points) < 2:
                continue
            x, y = np.array(sorted(points)).T
            slope = np.polyfit(np.log(x[-4:]), np.log(y[-4:]), 1)[0]
            text = f"{method}: slope {slope:.2f}" if axis is left else method
            axis.loglog(x, y, marker=MARKERS[method], c=COLOURS[method], label=text)
        axis.set_xlabel(label)
        axis.set_ylabel("evaluations to the end of the scene")
        axis.grid(color="0.9")
        axis.legend(frameon=False)


if __name__ == "__main__":
    main()
