"""Table 3: wall time and memory of both methods, and of rodsim as it is meant to be used."""

import tempfile
from pathlib import Path
from time import perf_counter

import numpy as np
from child import run_python
from common import CONFIGS, interleaved
from host import Neighbours
from paper_table import PAPER_STEPS, programs
from speedup import Solve

from figures.report import Row, verdict, write_csv

GIB = Path(__file__).resolve().parents[1] / "gib"
EULER, SHIPPED = "rodsim, forward Euler, scaled", "rodsim, as shipped (rkc)"  # of paper_table
COUNTS = (1, 2)


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
    """Time both methods on the closed ring in rounds; Euler and gIB over a stretch, scaled."""
    euler_steps, gib_steps, repeats = (200, 20, 3) if place.quick else (500, 30, 15)
    ours = programs(euler_steps)
    measured = {("gIB", n): GibSteps(n, gib_steps) for n in COUNTS}
    for name in (EULER, SHIPPED):
        config, overrides, _ = ours[name]
        measured |= {(name, n): Solve(config, n, *overrides) for n in COUNTS}
    neighbours = Neighbours()
    runs = interleaved(measured, repeats, "Table 3")
    busy = str(neighbours)
    scale = {"gIB": PAPER_STEPS / gib_steps, EULER: ours[EULER][2], SHIPPED: 1.0}
    rounds = {
        key: scale[key[0]] * np.array([run["wall"] for run in results])
        for key, results in runs.items()
    }
    memory = _memory(ours)
    seconds = {key: float(np.median(values)) for key, values in rounds.items()}
    write_csv(
        place.path("table3.csv"),
        {
            "program": [name for name, _ in rounds],
            "threads": [n for _, n in rounds],
            "wall time (s), median": list(seconds.values()),
            "lower quartile": [float(np.quantile(v, 0.25)) for v in rounds.values()],
            "upper quartile": [float(np.quantile(v, 0.75)) for v in rounds.values()],
        },
    )
    library = measured["gIB", 1].library
    note = f"{library}; {gib_steps} and {euler_steps} steps timed, scaled; others used {busy} cores"
    return [*_time_rows(seconds, rounds, note), _memory_row(memory)]


def _memory(ours):
    """Peak memory, kB, of whole processes: both methods, and an import of what they share."""
    config, overrides, _ = ours[EULER]
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
    peaks = {"gIB": gib.peak_kb, "rodsim": stokes.peak_kb, "imports": floor.peak_kb}
    return {name: round(peak) for name, peak in peaks.items()}


def _time_rows(seconds, rounds, note):
    def ratio(slow, fast):
        """Median of the ratios within rounds: a busy neighbour meets both sides."""
        return float(np.median(rounds[slow] / rounds[fast]))

    gib, euler, shipped = (seconds[name, 1] for name in ("gIB", EULER, SHIPPED))
    faster, speedup = ratio(("gIB", 1), (EULER, 1)), ratio((EULER, 1), (EULER, 2))
    return [
        Row(
            "Table 3",
            "100 000 steps of 1e-6 s: gIB 15:12:27, regularized Stokes 1:15:14 serial: 12 times "
            "faster",
            f"gIB {gib:.0f} s, {1e3 * gib / PAPER_STEPS:.1f} ms a step; rodsim {euler:.1f} s, "
            f"{1e6 * euler / PAPER_STEPS:.0f} us a step: {faster:.0f} times faster ({note})",
            verdict(faster >= 12),
        ),
        Row(
            "Table 3",
            "the same 0.1 s by our default integrator (not in the paper)",
            f"rodsim {shipped:.3f} s serial, {seconds[SHIPPED, 2]:.3f} s on 2 threads: "
            f"{ratio(('gIB', 1), (SHIPPED, 1)):.0f} and {ratio(('gIB', 2), (SHIPPED, 2)):.0f} "
            "times faster than the gIB method on as many",
            "-",
        ),
        Row(
            "Table 3",
            "2 processors: 0:43:16, 1.74 times faster than serial",
            f"rodsim {seconds[EULER, 2]:.1f} s, {speedup:.2f} times; "
            f"gIB {seconds['gIB', 2]:.0f} s, {ratio(('gIB', 1), ('gIB', 2)):.2f} times",
            verdict(speedup >= 1.74),
        ),
    ]


def _memory_row(memory):
    above = {name: memory[name] - memory["imports"] for name in ("gIB", "rodsim")}
    return Row(
        "Table 3",
        "memory: gIB 87 532 kB, regularized Stokes 4 808 kB: 18 times less",
        f"whole processes {memory['gIB']} and {memory['rodsim']} kB; above their imports "
        f"({memory['imports']} kB of Python, NumPy, Numba, h5py) {above['gIB']} and "
        f"{above['rodsim']} kB, most of it the compiler; the arrays alone: 31 MB and 93 kB",
        verdict([memory["rodsim"] < memory["gIB"], above["rodsim"] * 10 < above["gIB"]]),
    )
