"""A sweep beside as many commands one after another: open rods, wall time and CPU time.

    python benchmarks/sweeps.py [--runs 100] [--commands 5]

Commands are timed before and after the sweep. CPU time counts every process, so that what others do
on the machine hardly shows: of the sweep it is to be divided by the cores that it fills.
"""

import argparse
import os
import resource
import subprocess
import tempfile
from time import perf_counter

import numpy as np
from common import CONFIGS

from rodsim.processes import this_rodsim, usable_cores

CASE, KEY = str(CONFIGS / "open_rod.yaml"), "rods.rod.strain_twist.0"
ENVIRONMENT = {**os.environ, "NUMBA_NUM_THREADS": "1"}


def cost(folder, *words):
    """Return (wall, CPU) seconds of a command."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    line = [*this_rodsim(), *words]
    subprocess.run(line, cwd=folder, env=ENVIRONMENT, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return perf_counter() - start, spent


def commands(folder, values):
    """Return the costs of a command for each value."""
    return [
        cost(folder, "run", CASE, "--set", f"{KEY}={value}", "-o", "one.h5", "--overwrite", "-q")
        for value in values
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--commands", type=int, default=5)
    options = parser.parse_args()
    values = [round(1.0 + 0.3 * k / options.runs, 6) for k in range(options.runs)]
    with tempfile.TemporaryDirectory() as folder:
        commands(folder, values[:1])  # compiles
        single = commands(folder, values[: options.commands])
        wall, spent = cost(folder, "sweep", CASE, "--set", f"{KEY}={values}", "-q")
        single += commands(folder, values[: options.commands])
    one_wall, one_spent = np.median(single, axis=0)
    cores = usable_cores()
    print(f"a command: {one_wall:.2f} s, CPU {one_spent:.2f} s")
    print(f"{options.runs} runs by sweep: {wall:.1f} s, CPU {spent:.1f} s on {cores} cores")
    by_wall, by_cpu = np.array([one_wall / wall, one_spent * cores / spent]) * options.runs
    print(f"commands over sweep: {by_wall:.1f} in wall time, {by_cpu:.1f} in CPU time a core")


if __name__ == "__main__":
    main()
