"""Whole processes: how long they take, and how much memory they take at most."""

import os
import subprocess
import sys
from dataclasses import dataclass

import click

# The environment before rodsim's settings changed it: children are to choose for themselves.
ENVIRONMENT = dict(os.environ)

FLOOR = ("-c", "import numpy, numba, h5py")

# ru_maxrss of a child counts its parent up to the moment of exec. So the parent that measures is
# a bare interpreter of about 10 MB, smaller than anything measured here.
LAUNCHER = """
import os, sys, time
begin = time.perf_counter()
to_stderr = [(os.POSIX_SPAWN_DUP2, 2, 1)]
pid = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ, file_actions=to_stderr)
_, status, usage = os.wait4(pid, 0)
print(os.waitstatus_to_exitcode(status), time.perf_counter() - begin, usage.ru_maxrss)
"""


@dataclass(frozen=True)
class Child:
    """Wall time and peak resident memory of a process that has ended."""

    seconds: float
    peak_kb: float


def run_python(arguments, folder, **environment) -> Child:
    """Run Python with some arguments in a folder and wait for it; ``environment`` adds to ours."""
    command = [sys.executable, "-I", "-S", "-c", LAUNCHER, sys.executable, *map(str, arguments)]
    done = subprocess.run(
        command, cwd=folder, env={**ENVIRONMENT, **environment}, capture_output=True, text=True
    )
    code, seconds, peak = done.stdout.split() if done.stdout else (done.returncode, 0, 0)
    if int(code) != 0:
        shown = " ".join(map(str, arguments))
        raise click.ClickException(f"{shown} ended with {code}:\n{done.stderr[-2000:]}")
    return Child(float(seconds), float(peak) / (1024.0 if sys.platform == "darwin" else 1.0))
