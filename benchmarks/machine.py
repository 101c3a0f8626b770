"""The machine and the software a benchmark ran on."""

import math
import os
import platform
import re
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
        "threading layer": _threading_layer(numba),
        "vectors": _vectors(),
    }


def load_average() -> str:
    """Return the load average of the last minute: above 0, somebody else is running."""
    return f"{os.getloadavg()[0]:.2f}" if hasattr(os, "getloadavg") else "unknown"


def _model():
    try:
        with open("/proc/cpuinfo") as lines:
            return next(line.split(":", 1)[1].strip() for line in lines if "model name" in line)
    except (OSError, StopIteration):
        return platform.processor() or "unknown"


def _llvm_name():
    import llvmlite.binding

    return llvmlite.binding.get_host_cpu_name()


def _threading_layer(numba):
    @numba.njit(parallel=True)
    def start(values):
        for i in numba.prange(values.size):
            values[i] = i

    import numpy as np

    start(np.empty(2))
    return numba.threading_layer()


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
