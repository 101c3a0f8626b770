"""The machine and the software a benchmark ran on."""

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
    return {
        "CPU": f"{_model()} ({_llvm_name()}), {os.cpu_count()} cores",
        "system": f"{platform.system()} {platform.machine()}",
        "Python": platform.python_version(),
        "packages": ", ".join(f"{name} {version(name)}" for name in ("rodsim", "numba", "numpy")),
        "threading layer": _threading_layer(),
        "vectors": _vectors(),
    }


class Neighbours:
    """How many cores other processes have used since this object was made."""

    def __init__(self):
        self.begin = _clocks()

    def __str__(self):
        if self.begin is None:
            return "unknown"
        wall, busy, own = (now - then for now, then in zip(_clocks(), self.begin, strict=True))
        return f"{max(0.0, (busy - own) / wall):.2f}"


def _clocks():
    """Return wall time, and CPU time of all processes and of this one with its children."""
    try:
        with open("/proc/stat") as lines:
            user, nice, system = map(int, lines.readline().split()[1:4])
    except OSError:
        return None
    busy = (user + nice + system) / os.sysconf("SC_CLK_TCK")
    return time.perf_counter(), busy, sum(os.times()[:4])


def _model():
    try:
        with open("/proc/cpuinfo") as lines:
            return next(line.split(":", 1)[1].strip() for line in lines if "model name" in line)
    except (OSError, StopIteration):
        return platform.processor() or "unknown"


def _llvm_name():
    import llvmlite.binding

    return llvmlite.binding.get_host_cpu_name()


def _threading_layer():
    import numba
    import numpy as np

    @numba.njit(parallel=True)
    def start(values):
        for i in numba.prange(values.size):
            values[i] = i

    start(np.empty(2))
    return numba.threading_layer()


def _vectors():
    """Return the width that LLVM chooses for a sum of reciprocal square roots, as ours are."""
    import numba

    from rodsim.compiled.flags import SUM_FLAGS

    @numba.njit("float64(float64[::1])", fastmath=set(SUM_FLAGS), error_model="numpy")
    def probe(values):
        total = 0.0
        for i in range(values.size):
            total += 1.0 / math.sqrt(values[i])
        return total

    (assembly,) = probe.inspect_asm().values()
    widths = [BITS[letter] for letter in PACKED_SQUARE_ROOT.findall(assembly)]
    return f"{max(widths)} bits" if widths else "unknown"
