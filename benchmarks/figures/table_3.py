"""Table 3: wall time and memory of both methods, and of rodsim as it is meant to be used."""

import sys
import tempfile
from pathlib import Path
from time import perf_counter

import click
import numpy as np
from child import run_python
from common import CONFIGS, interleaved
from paper_table import PAPER_STEPS, programs
from speedup import Solve

from figures.report import Row, verdict, write_csv

GIB = Path(__file__).resolve().parents[1] / "gib"
PAPER_RATIO = 54747 / 4514  # 15:12:27 over 1:15:14
PAPER_TIMES = {"gIB": "15:12:27", "serial": "1:15:14", "two": "0:43:16"}


class GibSteps:
    """Call it for the seconds of some steps of the ring by the gIB method, after as many others."""

    def __init__(self, threads, steps):
        from gib.march import ImmersedRods, Setup

        from rodsim import load_case

        self.threads, self.steps = threads, steps
        case = load_case(CONFIGS / "closed_ring.yaml", ["fluid.density=1e-12"])
        self._set_threads()
        self.rods = ImmersedRods(case, Setup(threads=threads))
        self.library = self.rods.fluid.transforms.library
        for _ in range(5):
            self.rods.advance()

    def _set_threads(self):
        import numba

        numba.set_num_threads(self.threads)

    def __call__(self):
        self._set_threads()
        begin = perf_counter()
        for _ in range(self.steps):
            self.rods.advance()
        return {"wall": perf_counter() - begin}


def table_3(place) -> list[Row]:
    """Time both methods on the closed ring; Euler and gIB over a stretch, scaled."""
    euler_steps, gib_steps, repeats = (200, 20, 3) if place.quick else (2000, 100, 5)
    ours = programs(euler_steps)
    euler, shipped = "rodsim, forward Euler, scaled", "rodsim, as shipped (rkc)"
    counts = (1, 2)
    measured = {("gIB", n): GibSteps(n, gib_steps) for n in counts}
    for name in (euler, shipped):
        config, overrides, _ = ours[name]
        measured |= {(name, n): Solve(config, n, *overrides) for n in counts}
    runs = interleaved(measured, repeats, "Table 3")
    scale = {"gIB": PAPER_STEPS / gib_steps, euler: ours[euler][2], shipped: 1.0}
    seconds = {
        key: scale[key[0]] * float(np.median([run["wall"] for run in results]))
        for key, results in runs.items()
    }
    memory = _memory(ours, euler)
    write_csv(
        place.path("table3.csv"),
        {
            "threads": np.array([n for _, n in seconds]),
            "wall time (s)": np.array(list(seconds.values())),
        },
    )
    _show(seconds, memory)
    return _rows(seconds, memory, euler, shipped, measured["gIB", 1].library, gib_steps)


def _memory(ours, euler):
    """Peak memory, kB, of whole processes: both methods, and an import of what they share."""
    config, overrides, _ = ours[euler]
    sets = [word for item in overrides for word in ("--set", item)]
    short = [word for item in ("time.end=2e-5", "output.interval=2e-5", "fluid.density=1e-12")
             for word in ("--set", item)]  # fmt: skip
    case = CONFIGS / f"{config}.yaml"
    with tempfile.TemporaryDirectory() as folder:
        gib = run_python((GIB, case, "-o", "gib.h5", *short), folder)
        stokes = run_python(
            ("-m", "rodsim", "run", case, "--overwrite", "-q", "--threads", 1, *sets), folder
        )
        floor = run_python(("-c", "import numpy, numba, h5py"), folder)
    return {"gIB": gib.peak_kb, "rodsim": stokes.peak_kb, "imports": floor.peak_kb}


def _show(seconds, memory):
    for (name, threads), value in seconds.items():
        click.echo(f"  {name}, {threads} threads: {value:.3g} s", err=True)
    click.echo(f"  memory, kB: {memory}", err=True, file=sys.stderr)


def _rows(seconds, memory, euler, shipped, library, gib_steps):
    ratio = seconds["gIB", 1] / seconds[euler, 1]
    best = {n: seconds["gIB", n] / seconds[shipped, n] for n in (1, 2)}
    speedup = seconds[euler, 1] / seconds[euler, 2]
    above = {name: memory[name] - memory["imports"] for name in ("gIB", "rodsim")}
    per_step = {name: 1e3 * seconds[name, 1] / PAPER_STEPS for name in ("gIB", euler)}
    return [
        Row(
            "Table 3",
            f"100 000 steps of 1e-6 s: gIB {PAPER_TIMES['gIB']}, regularized Stokes "
            f"{PAPER_TIMES['serial']} serial: 12 times faster",
            f"gIB {seconds['gIB', 1]:.0f} s ({per_step['gIB']:.2f} ms a step, {library}, "
            f"{gib_steps} steps timed and scaled), rodsim {seconds[euler, 1]:.1f} s "
            f"({1e3 * per_step[euler]:.0f} us a step): {ratio:.0f} times faster",
            verdict(ratio >= 12),
        ),
        Row(
            "Table 3",
            "the same at our default integrator (not in the paper)",
            f"rodsim {seconds[shipped, 1]:.3f} s serial, {seconds[shipped, 2]:.3f} s on 2 threads: "
            f"{best[1]:.0f} and {best[2]:.0f} times faster than the gIB method",
            "-",
        ),
        Row(
            "Table 3",
            f"2 processors: {PAPER_TIMES['two']}, 1.74 times faster than serial",
            f"rodsim {seconds[euler, 2]:.1f} s, {speedup:.2f} times; "
            f"gIB {seconds['gIB', 2]:.0f} s, {seconds['gIB', 1] / seconds['gIB', 2]:.2f} times",
            verdict(speedup >= 1.74),
        ),
        Row(
            "Table 3",
            "memory: gIB 87 532 kB, regularized Stokes 4 808 kB: 18 times less",
            f"whole processes {memory['gIB']} and {memory['rodsim']} kB, above their imports "
            f"({memory['imports']} kB of Python, NumPy, Numba, h5py) {above['gIB']} and "
            f"{above['rodsim']} kB, most of it the compiler; the arrays alone: 31 MB and 93 kB",
            verdict([memory["rodsim"] < memory["gIB"], above["rodsim"] * 10 < above["gIB"]]),
        ),
    ]
