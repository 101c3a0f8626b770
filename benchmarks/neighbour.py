"""How much a run suffers from one busy process beside it, by threading layer."""

import contextlib
import subprocess
import sys
import tempfile
from pathlib import Path

import click
import numpy as np
from child import ENVIRONMENT, run_python
from common import CONFIGS, benchmark, interleaved, thread_counts
from tables import Spread, Table

LAYERS = ("tbb", "omp", "workqueue")
COLUMNS = {
    "layer": "threading layer",
    "threads": "threads",
    "quiet": "quiet, s",
    "busy": "beside a busy process, s",
    "ratio": "busy / quiet",
}
BUSY = "while True: pass"


@benchmark(full=7, short=2)
@click.option("--config", default="closed_ring", show_default=True, help="One of configs/.")
@click.option("--layer", "layers", multiple=True, type=click.Choice(LAYERS), default=LAYERS,
              help="Threading layer of Numba; again for more. tbb needs rodsim[fast].")  # fmt: skip
def main(quick, repeats, config, layers):
    """Measure whole runs with all cores, alone and beside one process that never waits.

    rodsim chooses tbb where it is installed, and GNU OpenMP with threads that sleep elsewhere.
    Fair sharing of two cores between two threads and the neighbour gives 1.5.
    """
    threads = thread_counts(None)[-1]
    with tempfile.TemporaryDirectory() as folder:
        runs = {
            (layer, busy): _Run(Path(folder), config, layer, threads, busy)
            for layer in layers
            for busy in (False, True)
        }
        for run in runs.values():
            run()  # compiles
        times = interleaved(runs, repeats, "runs")
    rows = [row(layer, threads, times) for layer in layers]
    return [Table(f"{config} beside a busy process", COLUMNS, rows)], lambda *axes: draw(
        rows, *axes
    )


class _Run:
    """Call it for the wall seconds of a run, if asked with a busy process beside it."""

    def __init__(self, folder, config, layer, threads, busy):
        self.folder, self.busy = folder, busy
        self.variables = {"NUMBA_THREADING_LAYER": layer, "XDG_CACHE_HOME": str(folder)}
        self.arguments = ("-m", "rodsim", "run", CONFIGS / f"{config}.yaml", "-o", "out.h5",
                          "--overwrite", "-q", "--threads", threads)  # fmt: skip

    def __call__(self):
        ENVIRONMENT.pop("NUMBA_CACHE_DIR", None)
        with _neighbour() if self.busy else contextlib.nullcontext():
            return run_python(self.arguments, self.folder, **self.variables).seconds


@contextlib.contextmanager
def _neighbour():
    process = subprocess.Popen([sys.executable, "-c", BUSY])
    try:
        yield
    finally:
        process.kill()
        process.wait()


def row(layer, threads, times):
    """Return one row of the table."""
    quiet, busy = (np.array(times[layer, state]) for state in (False, True))
    spreads = {"quiet": Spread.of(quiet), "busy": Spread.of(busy), "ratio": Spread.of(busy / quiet)}
    return {"layer": layer, "threads": threads, **spreads}


def draw(rows, left, right):
    """Left: wall times; right: their ratio."""
    names = [row["layer"] for row in rows]
    for shift, key in ((-0.2, "quiet"), (0.2, "busy")):
        errors = np.array([row[key].error for row in rows]).T
        places, heights = np.arange(len(rows)) + shift, [row[key].median for row in rows]
        left.bar(places, heights, width=0.4, yerr=errors, capsize=3, label=key)
    left.set(ylabel="a run, s", xticks=range(len(rows)), xticklabels=names)
    left.legend()
    errors = np.array([row["ratio"].error for row in rows]).T
    right.bar(names, [row["ratio"].median for row in rows], yerr=errors, capsize=3)
    right.axhline(2.5, color="0.6", label="at most 2.5")
    right.set(ylabel="busy / quiet")
    right.legend()


if __name__ == "__main__":
    main()
