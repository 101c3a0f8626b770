"""What the benchmarks share: options, rounds of measurements, pictures.

A benchmark is a function that returns its tables and a function that draws them; ``benchmark``
makes a command of it. Numba is imported only inside those functions: by then ``prepare`` has
chosen its cache and threading layer, as the ``rodsim`` command does.
"""

import functools
import os
import sys
from pathlib import Path
from time import perf_counter

import click
import numpy as np
from host import Neighbours, describe
from tables import show, write_csv

from rodsim.compiled.settings import prepare

CONFIGS = Path(__file__).resolve().parent.parent / "configs"

OUTPUT_OPTIONS = (
    click.option("--quick", is_flag=True, help="A short version: fewer sizes and repeats."),
    click.option("--repeats", type=click.IntRange(1), help="Repeats of every measurement."),
    click.option("--csv", "csv_path", type=click.Path(dir_okay=False, path_type=Path),
                 metavar="FILE", help="Write the tables to a CSV file as well."),
    click.option("--plot", "plot_path", type=click.Path(dir_okay=False, path_type=Path),
                 metavar="FILE.png", help="Draw the figures (needs rodsim[plot])."),
    click.option("--markdown", is_flag=True, help="Print the tables in Markdown, for a README."),
)  # fmt: skip


def benchmark(full: int, short: int):
    """Make a command of ``function(quick, repeats, **own) -> (tables, draw)``.

    ``full``, ``short``: the repeats by default, and with ``--quick``.
    """

    def decorate(function):
        @functools.wraps(function)
        def command(quick, repeats, csv_path, plot_path, markdown, **own):
            prepare()
            neighbours = Neighbours()
            repeats = repeats or (short if quick else full)
            tables, draw = function(quick=quick, repeats=repeats, **own)
            machine = {"cores used by others meanwhile": str(neighbours), **describe()}
            show(tables, machine, repeats, markdown)
            if csv_path:
                write_csv(csv_path, tables, machine)
            if plot_path:
                picture(plot_path, draw)

        for option in reversed(OUTPUT_OPTIONS):
            command = option(command)
        return click.command(context_settings={"help_option_names": ["-h", "--help"]})(command)

    return decorate


def interleaved(measurements: dict, repeats: int, label: str) -> dict:
    """Return the results of each measurement, by its key, of ``repeats`` rounds over all of them.

    In rounds, so that a busy neighbour or a changing clock meets all of them alike, and the r-th
    results of any two can be compared as a pair.
    """
    results = {key: [] for key in measurements}
    with click.progressbar(length=repeats * len(measurements), label=label, file=sys.stderr) as bar:
        for _ in range(repeats):
            for key, measure in measurements.items():
                results[key].append(measure())
                bar.update(1)
    return results


class Timed:
    """Call it for the seconds of one call, the mean over a sample of calls.

    The same calls go before each sample, untimed: a thread that slept through the measurements of
    others starts on the core of the thread that wakes it, and takes milliseconds to find its own.
    With ``clock=time.process_time``: seconds of CPU, for serial work, whatever others do.
    """

    def __init__(self, call, sample_seconds=1e-2, clock=perf_counter):
        self.call, self.clock = call, clock
        call()  # compiles
        begin = clock()
        call()
        self.calls = max(1, round(sample_seconds / max(clock() - begin, 1e-6)))

    def __call__(self):
        self._run()
        begin = self.clock()
        self._run()
        return (self.clock() - begin) / self.calls

    def _run(self):
        for _ in range(self.calls):
            self.call()


def thread_counts(text: str | None) -> list[int]:
    """Return 1 and what ``--threads 2,4`` lists; by default 2, 3, ... or 2, 4, 8, ... and all."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    if text is None:
        some = range(1, cores) if cores <= 8 else (1 << k for k in range(cores.bit_length()))
        return sorted({1, *(n for n in some if n < cores), cores})
    try:
        counts = sorted({1, *(int(item) for item in text.split(","))})
    except ValueError:
        raise click.BadParameter(f"--threads takes numbers such as 1,2,4, not {text!r}") from None
    if not 1 == counts[0] <= counts[-1] <= cores:
        raise click.BadParameter(f"--threads must lie between 1 and the number of cores, {cores}")
    return counts


threads_option = click.option(
    "--threads", metavar="N,...", help="Numbers of threads beside 1, e.g. 2,4; default: up to all."
)


def picture(path, draw):
    """Let ``draw(left, right)`` fill two axes side by side, and write them to a file."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 4.5), layout="constrained")
    draw(*figure.subplots(1, 2))
    figure.savefig(path, dpi=130)


def curve(axes, rows, x, y, **style):
    """Draw a column of spreads over a column of numbers, with quartiles as error bars."""
    rows = [row for row in rows if row.get(y) is not None]
    errors = np.array([row[y].error for row in rows]).T
    medians = [row[y].median for row in rows]
    axes.errorbar([row[x] for row in rows], medians, errors, marker="o", capsize=3, **style)
