"""Python with Numba's CUDA simulator in place of a card: a process of its own, nothing compiled.

A block has few threads there, for each is a thread of Python. The kernels are the same.
"""

import os
import subprocess
import sys

START = """
import sys
sys.setswitchinterval(1e-5)  # who waits for the threads of a block does so by asking
import rodsim.flows.card.kernels as kernels
kernels.THREADS, kernels.BLOCKS, kernels.LEAST = 3, 4, 3
from threading import Lock
from numba.cuda.simulator.kernelapi import FakeCUDAShared
unsafe, one_at_a_time = FakeCUDAShared.array, Lock()
def array(self, shape, dtype):  # two threads at once would each get memory of its own
    with one_at_a_time:
        return unsafe(self, shape, dtype)
FakeCUDAShared.array = array
"""
SIMULATED = {"NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": "1"}


def simulated(code, folder, *arguments):
    """Run code on the simulator; return what it printed."""
    done = subprocess.run(
        [sys.executable, "-c", START + code, *map(str, arguments)],
        cwd=folder, env={**os.environ, **SIMULATED},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout
