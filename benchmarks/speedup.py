"""Serial against threads for the shipped scenes, and beside the paper's Table 3."""

import time

import click
import numpy as np
from common import (
    CONFIGS,
    Timed,
    benchmark,
    curve,
    interleaved,
    thread_counts,
    threads_option,
)
from paper_table import compare
from pieces import sum_of
from tables import Spread, Table

SCENES = ("open_rod", "closed_ring", "flagellum")
COLUMNS = {
    "scene": "scene",
    "points": "M",
    "threads": "threads",
    "steps": "steps",
    "evaluations": "evaluations",
    "wall": "solve, ms",
    "step": "a step, us",
    "sum": "an evaluation: sum alone, us",
    "rest": "the rest, us",
    "speedup": "speed-up",
    "efficiency": "efficiency",
    "busy": "cores busy",
}


@benchmark(full=15, short=3)
@threads_option
@click.option("--paper-steps", type=click.IntRange(10), default=2000, show_default=True,
              help="Steps of the paper's run to measure and scale to 100 000.")  # fmt: skip
def main(quick, repeats, threads, paper_steps):
    """Solve the three scenes in memory, serial and threaded; compare with the paper's Table 3.

    No output file is written. Compiling is done before; a speed-up is taken round by round.
    "Cores busy" is CPU time over wall time: when it stays near 1 with two threads, the second
    core was taken by somebody else, and the speed-up says nothing.
    """
    counts = thread_counts(threads)
    solves = {(name, n): Solve(name, n, *shorter(name, quick)) for name in SCENES for n in counts}
    runs = interleaved(solves, repeats, "solves")
    scenes = Table(
        "Serial against threads",
        COLUMNS,
        [row(solves[key], runs[key], runs[key[0], 1]) for key in solves],
    )
    steps = min(paper_steps, 200) if quick else paper_steps
    paper = compare(Solve, counts, steps, repeats=max(2, repeats // 3))
    return [scenes, paper], lambda *axes: draw(scenes.rows, *axes)


class Solve:
    """Call it to solve a case in memory: what ``rodsim run`` does between its frames.

    Without the watch over the stability of fixed steps: it costs at the start of a run only, and
    would be scaled with the rest.
    """

    def __init__(self, config, threads, *overrides):
        from rodsim.case import load_case
        from rodsim.scene.build import build_scene

        self.name, self.threads = config, threads
        self.case = load_case(CONFIGS / f"{config}.yaml", overrides)
        self.scene = build_scene(self.case)
        next(self._steps(self._machine()))  # compiles
        self.sum = Timed(sum_of(self.scene, threads))

    def _machine(self):
        from rodsim.run.machine import Machine

        return Machine(self.case, self.scene, force=True)

    def _steps(self, machine):
        return machine.integrator.steps(self.scene.initial, self.case.time.end)

    def __call__(self):
        """Return what :meth:`on` does, and the seconds of one sum."""
        return {**self.on(self.threads), "sum": self.sum()}

    def on(self, threads):
        """Return wall and CPU seconds, steps (rejected too) and evaluations of a solve."""
        wall, cpu = time.perf_counter(), time.process_time()
        machine = self._machine()
        with machine.threads(threads):
            for step in self._steps(machine):
                machine.watch.check(step)
        return {
            "wall": time.perf_counter() - wall,
            "cpu": time.process_time() - cpu,
            "steps": machine.integrator.accepted + machine.integrator.rejected,
            "evaluations": machine.system.evaluations,
        }


def shorter(config, quick):
    """Return overrides that cut a scene to a tenth of its time, for the short version."""
    ends = {"open_rod": 5e-4, "closed_ring": 1e-2, "flagellum": 7.853981633974483e-3}
    return (f"time.end={ends[config]!r}",) if quick else ()


def row(solve, runs, serial):
    """Return one row of the table: a scene with a number of threads."""
    wall, cpu, sums = (np.array([run[key] for run in runs]) for key in ("wall", "cpu", "sum"))
    speedup = np.array([run["wall"] for run in serial]) / wall
    steps, evaluations = runs[0]["steps"], runs[0]["evaluations"]
    return {
        "scene": solve.name,
        "points": solve.scene.rods.points,
        "threads": solve.threads,
        "steps": steps,
        "evaluations": evaluations,
        "wall": Spread.of(wall, 1e3),
        "step": Spread.of(wall, 1e6 / steps),
        "sum": Spread.of(sums, 1e6),
        "rest": Spread.of(wall / evaluations - sums, 1e6),
        "speedup": Spread.of(speedup),
        "efficiency": Spread.of(speedup, 1.0 / solve.threads),
        "busy": Spread.of(cpu / wall),
    }


def draw(rows, left, right):
    """Left: speed-up against threads, with the paper's; right: where an evaluation goes."""
    most = max(row["threads"] for row in rows)
    left.plot([1, most], [1, most], color="0.8", label="ideal")
    for name in SCENES:
        curve(left, [row for row in rows if row["scene"] == name], "threads", "speedup", label=name)
    left.plot([1, 2, 4], [1, 1.74, 2.7], "kx", label="paper, closed ring")
    left.set(xlabel="threads", ylabel="speed-up")
    left.legend()
    labels = [f"{row['scene']}, {row['threads']}" for row in rows]
    bottom = np.zeros(len(rows))
    for key, label in (("sum", "sum"), ("rest", "the rest")):
        heights = np.array([row[key].median for row in rows])
        errors = np.array([row[key].error for row in rows]).T
        right.barh(labels, heights, left=bottom, xerr=errors, capsize=3, label=label)
        bottom += heights
    right.set(xlabel="an evaluation, us (scene, threads)")
    right.legend()


if __name__ == "__main__":
    main()
