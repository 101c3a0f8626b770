"""The machine and the software a benchmark ran on."""

import functools
import math
import os
import platform
import re
import time
from importlib.metadata import version

PACKED_SQUARE_ROOT = re.compile(r"sqrtpd\s.*%([xyz])mm")
BITS = {"x": 128, "y": 256, "z": 512}


def describe() -> dict[str, str]:
    """Return what decides how fast rodsim runs, by name. Call after ``settings.prepare``."""
    import numba

    return {
        "CPU": f"{_model()} ({_llvm_name()}), {os.cpu_count()} cores",
        "system": f"{platform.system()} {platform.machine()}",
        "Python": platform.python_version(),
        "packages": ", ".join(f"{name} {version(name)}" for name in ("rodsim", "numba", "numpy")),
        "threading layer": numba.threading_layer(),
        "vectors": _vectors(),
    }


def cores_free(seconds: float = 0.3) -> float:
    """Return CPU time over wall time of all threads at work: below their number, others run too."""
    import numpy as np

    work, values = _busy_work(), np.ones(4_000_000)
    work(values)
    wall, cpu = time.perf_counter(), time.process_time()
    while time.perf_counter() - wall < seconds:
        work(values)
    return (time.process_time() - cpu) / (time.perf_counter() - wall)


@functools.cache
def _busy_work():
    import numba

    @numba.njit(parallel=True)
    def work(values):
        for i in numba.prange(values.size):
            values[i] = math.sin(values[i])

    return work


def _model():
    try:
        with open("/proc/cpuinfo") as lines:
            return next(line.split(":", 1)[1].strip() for line in lines if "model name" in line)
    except (OSError, StopIteration):
        return platform.processor() or "unknown"


def _llvm_name():
    import llvmlite.binding

    return llvmlite.binding.get_host_cpu_name()


def _vectors():
    """Return the width that LLVM chooses for a sum of reciprocal square roots, as ours are."""
    import numba

    from rodsim.jit import SUM_FLAGS

    @numba.njit("float64(float64[::1])", fastmath=set(SUM_FLAGS), error_model="numpy")
    def probe(values):
        total = 0.0
        for i in range(values.size):
            total += 1.0 / math.sqrt(values[i])
        return total

    (assembly,) = probe.inspect_asm().values()
    widths = [BITS[letter] for letter in PACKED_SQUARE_ROOT.findall(assembly)]
    return f"{max(widths)} bits" if widths else "unknown"
