"""How every kernel of rodsim is compiled: one place for flags and array types.

``reassoc`` is what lets LLVM vectorise a sum; ``nnan`` and ``ninf`` are left out on purpose, so a
NaN or an infinity in a state always shows. ``error_model="numpy"``: a checked division would stop
vectorisation. Kernels have signatures, so each is compiled (or read from the cache) once, when its
module is imported, and never again for another array layout. What is ``unsigned`` is compiled with
the kernels that call it, and costs a run nothing to load. So are the sums: only those are compiled
that a scene calls. A part (:mod:`rodsim.compiled.kernels`) is compiled when a scene first lists it.

Loops over points use unsigned indices (``ONE`` and ``np.uint64``): for signed ones Numba adds the
wrap-around of negative indices to each access, and LLVM then gives up vectorising.
"""

from functools import partial

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from rodsim.compiled import threads
from rodsim.compiled.cache import cached_cfunc, cached_njit
from rodsim.compiled.kernels import interpreted, jit_is_off

threads.start()

VEC = "float64[::1]"
MAT = "float64[:, ::1]"
TRIADS = "float64[:, :, ::1]"
INTS = "int64[::1]"
INT_MAT = "int64[:, ::1]"
INTS32 = "int32[::1]"
INT_MAT32 = "int32[:, ::1]"
BOOLS = "boolean[::1]"
RODS = f"Tuple(({INTS}, {INTS}, {BOOLS}, {VEC}, {MAT}))"  # nodes.Rods.tables
STATE = f"Tuple(({MAT}, {TRIADS}, {MAT}))"  # position, director, tracer
PART = f"void({VEC}, {VEC}, {RODS}, {STATE}, {MAT}, UniTuple({MAT}, 2))"  # compiled.kernels
SUM = f"void(int64, {MAT}, {MAT}, {MAT}, float64, float64, float64, {MAT})"  # compiled.kernels
RUN = SUM.replace("int64", "int64, int64")  # of targets, flows.by_threads
WORK = f"Tuple(({STATE}, {MAT}, {TRIADS}))"  # a state, loads, loads or velocities of each account
EVALUATION = f"void({INT_MAT}, {VEC}, {VEC}, {RODS}, {STATE}, {WORK}, {VEC}, {VEC})"  # scene.loop
ONE = np.uint64(1)

# What Numba may run in parallel; all but prange costs seconds of compiling and saves nothing.
PARALLEL = (
    "prange", "numpy", "setitem", "inplace_binop", "comprehension", "reduction", "stencil", "fusion"
)  # fmt: skip
SUM_FLAGS = {"reassoc", "contract", "arcp", "nsz"}

kernel = partial(cached_njit, error_model="numpy", no_cfunc_wrapper=True)
parallel_kernel = partial(cached_njit, error_model="numpy", parallel=True, fastmath=SUM_FLAGS)
summed = partial(cached_njit, error_model="numpy", fastmath=SUM_FLAGS)  # the same, reordered
threaded_kernel = partial(
    cached_njit,
    error_model="numpy",
    fastmath=SUM_FLAGS,
    parallel={name: name == "prange" for name in PARALLEL},
)
unsigned = kernel  # without a signature: compiled with whatever calls it
inline = partial(cached_njit, error_model="numpy", inline="always")


def compile_part(function, signature, **options):
    """Compile a part or a sum, or read it from the cache."""
    return cached_cfunc(function, signature, error_model="numpy", **options)


def _jump(context, builder, signature, arguments):
    """Write the call of the function at the first argument, with the others."""
    kinds = [context.get_value_type(kind) for kind in signature.args[1:]]
    function = ir.FunctionType(context.get_value_type(types.none), kinds)
    place = builder.inttoptr(arguments[0], function.as_pointer())
    builder.call(place, arguments[1:])
    return context.get_dummy_value()


@intrinsic
def _call_at(typing, address, row, fixed, rods, state, loads, velocities):
    """Call the part whose machine code lies at an address."""
    arguments = (row, fixed, rods, state, loads, velocities)
    return types.void(types.int64, *arguments), _jump


@intrinsic
def _sum_at(typing, address, run, targets, sources, loads, epsilon, viscosity, wall, out):
    """Call the sum whose machine code lies at an address."""
    arguments = (run, targets, sources, loads, epsilon, viscosity, wall, out)
    return types.void(types.int64, *arguments), _jump


@intrinsic
def _run_at(typing, address, begin, end, targets, sources, loads, epsilon, viscosity, wall, out):
    """Call a sum for a run of targets."""
    arguments = (targets, sources, loads, epsilon, viscosity, wall, out)
    return types.void(types.int64, types.int64, types.int64, *arguments), _jump


@intrinsic
def _evaluation_at(typing, address, table, numbers, driven, rods, base, work, y, out):
    """Call the evaluation whose machine code lies at an address."""
    arguments = (table, numbers, driven, rods, base, work, y, out)
    return types.void(types.int64, *arguments), _jump


call_evaluation = interpreted if jit_is_off() else _evaluation_at
# Numba's own is not kept in its cache: it holds the address that the function has now.
thread_count = (
    numba.get_num_threads
    if jit_is_off()
    else types.ExternalFunction("get_num_threads", types.int32())
)
call_sum = interpreted if jit_is_off() else _sum_at
call_run = interpreted if jit_is_off() else _run_at
call_part = interpreted if jit_is_off() else _call_at
