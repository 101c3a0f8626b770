"""Table 3 of Olson, Lim & Cortez (2013), and the same run by rodsim."""

import tempfile

import numpy as np
from child import FLOOR, run_python
from common import CONFIGS, interleaved
from tables import Spread, Table

PAPER_STEPS = 100_000  # 0.1 s in steps of 1e-6 s (Table 1; the coil is reached "in around 0.1 s")
PAPER = (  # program, threads, h, min, s, kB
    ("paper, gIB", 1, (15, 12, 27), 87532),
    ("paper, regularized Stokes", 1, (1, 15, 14), 4808),
    ("paper, regularized Stokes", 2, (0, 43, 16), 4880),
    ("paper, regularized Stokes", 4, (0, 27, 57), 5020),
)
PAPER_SERIAL = 4514.0  # s, 1:15:14
COLUMNS = {
    "program": "program",
    "threads": "threads",
    "wall": "wall time, s",
    "clock": "h:min:s",
    "speedup": "against its own serial run",
    "factor": "against the paper's serial run",
    "memory": "peak memory, kB",
    "above": "above the imports, kB",
}
MARKERS = (
    "rods.ring.strain_twist=[1.2, 0, 0.6]",
    "tracers.inner={kind: tube, rod: ring, radius: 0.35, around: 8, along: 100}",
    "tracers.outer={kind: tube, rod: ring, radius: 0.70, around: 8, along: 100}",
)
MEMORY_REPEATS = 3


def programs(steps):
    """Return what rodsim runs beside the paper: name -> (config, overrides, factor on the time).

    The paper counts the same number of fluid markers in both methods and does not say how many:
    rodsim runs without any, and with two layers of 800.
    """
    end = steps * 1e-6
    method = ("time.integrator=euler", "time.step=1e-6")
    euler = (*method, f"time.end={end!r}", f"output.interval={end!r}")
    scale = PAPER_STEPS / steps
    return {
        "rodsim, forward Euler, scaled": ("closed_ring", euler, scale),
        "same, 1600 fluid markers": ("closed_ring_low_twist", euler + MARKERS, scale),
        "rodsim, as shipped (rkc)": ("closed_ring", (), 1.0),
    }


def compare(solve, counts, steps, repeats):
    """Return Table 3 with our rows below; ``solve`` is the class that solves a case in memory."""
    ours = programs(steps)
    solves = {
        (name, n): solve(config, n, *overrides)
        for name, (config, overrides, _) in ours.items()
        for n in counts
    }
    runs = interleaved(solves, repeats, "the paper's run")
    memory = peak_memory(ours, counts)
    rows = [_paper_row(*entry) for entry in PAPER]
    for name, n in solves:
        wall, serial = (
            ours[name][2] * np.array([run["wall"] for run in runs[name, m]]) for m in (n, 1)
        )
        rows.append(
            {
                "program": name,
                "threads": n,
                "wall": Spread.of(wall),
                "clock": _clock(float(np.median(wall))),
                "speedup": Spread.of(serial / wall),
                "factor": Spread.of(PAPER_SERIAL / wall),
                "memory": Spread.of(memory[name, n]),
                "above": Spread.of(memory[name, n] - np.median(memory[None])),
            }
        )
    title = (
        f"The paper's Table 3, and its run by rodsim (Euler: {steps} of {PAPER_STEPS} steps, "
        f"scaled; {repeats} repeats, memory {MEMORY_REPEATS})"
    )
    return Table(title, COLUMNS, rows)


def _paper_row(program, threads, clock, memory):
    hours, minutes, seconds = clock
    wall = 3600 * hours + 60 * minutes + seconds
    return {
        "program": program,
        "threads": threads,
        "wall": wall,
        "clock": _clock(wall),
        "speedup": None if "gIB" in program else PAPER_SERIAL / wall,
        "factor": PAPER_SERIAL / wall,
        "memory": memory,
    }


def _clock(seconds):
    minutes, rest = divmod(seconds, 60)
    return f"{minutes // 60:.0f}:{minutes % 60:02.0f}:{rest:04.1f}"


def peak_memory(ours, counts):
    """Return the peak memory (kB) of ``rodsim run`` for each program, and of the imports (None)."""
    with tempfile.TemporaryDirectory() as folder:
        commands = {None: FLOOR}
        for name, (config, overrides, _) in ours.items():
            sets = [word for item in overrides for word in ("--set", item)]
            run = ("-m", "rodsim", "run", CONFIGS / f"{config}.yaml", "--overwrite", "-q", *sets)
            commands |= {(name, n): (*run, "--threads", n) for n in counts}
        children = {key: _Peak(command, folder) for key, command in commands.items()}
        peaks = interleaved(children, MEMORY_REPEATS, "memory")
    return {key: np.array(values) for key, values in peaks.items()}


class _Peak:
    def __init__(self, command, folder):
        self.command, self.folder = command, folder

    def __call__(self):
        return run_python(self.command, self.folder).peak_kb
