"""How every kernel of rodsim is compiled: one place for flags and array types.

``reassoc`` is what lets LLVM vectorise a sum; ``nnan`` and ``ninf`` are left out on purpose, so a
NaN or an infinity in a state always shows. ``error_model="numpy"``: a checked division would stop
vectorisation. Kernels have signatures, so each is compiled (or read from the cache) once, when its
module is imported, and never again for another array layout. Parts have none: they are compiled
with the kernels that call them, and cost a run nothing to load. Nor have the sums, so that only
those are compiled that a scene calls.

Loops over points use unsigned indices (``ONE`` and ``np.uint64``): for signed ones Numba adds the
wrap-around of negative indices to each access, and LLVM then gives up vectorising.
"""

from functools import partial

import numpy as np

from rodsim.compiled import threads
from rodsim.compiled.cache import cached_njit

threads.start()

VEC = "float64[::1]"
MAT = "float64[:, ::1]"
TRIADS = "float64[:, :, ::1]"
INTS = "int64[::1]"
BOOLS = "boolean[::1]"
RODS = f"Tuple(({INTS}, {INTS}, {BOOLS}, {VEC}, {MAT}))"  # rods.state.Rods.tables
BASE = f"Tuple(({MAT}, {TRIADS}, {MAT}))"  # position, director, tracer of a state
WORK = f"Tuple(({MAT}, {TRIADS}, {MAT}, {MAT}, {MAT}))"  # the same, internal, loads
SYSTEM = f"{RODS}, UniTuple(float64, 2), {BASE}, {WORK}"  # what an evaluation takes
ONE = np.uint64(1)

SUM_FLAGS = {"reassoc", "contract", "arcp", "nsz"}

kernel = partial(cached_njit, error_model="numpy")
parallel_kernel = partial(cached_njit, error_model="numpy", parallel=True, fastmath=SUM_FLAGS)
part = kernel  # without a signature
inline = partial(cached_njit, error_model="numpy", inline="always")
