"""Numba's threads: started once, as many as a scene is worth, and what they cannot do."""

import os
import threading
from contextlib import contextmanager

import numba

from rodsim.compiled.settings import LAYERS, load_tbb
from rodsim.errors import UsageError

PAIR_SECONDS = 1.5e-9  # one pair of the sums on one core
# A sum must last this long, serial, to be worth sharing out: waking a thread that sleeps in GNU
# OpenMP or in Numba's work queue costs 40-100 us, in tbb 1-2 us.
WORTHWHILE = {"tbb": 3e-5, "omp": 3e-4, "workqueue": 3e-4}
_one_at_a_time = threading.RLock()
_started_in = {}  # the layer, and the process its threads were started in


def start() -> None:
    """Start the threads of Numba's threading layer, of tbb where that is installed.

    A function from the cache can hold parallel code without Numba knowing it: the layer must be
    there before it is loaded, or LLVM ends the process: "Symbol not found: allocate_sched". The
    tbb of pip lies where Numba does not look. Raises UsageError where no layer can be had.
    """
    load_tbb()
    try:
        numba.get_num_threads()
    except ValueError as error:
        asked = os.environ.get("NUMBA_THREADING_LAYER", "default")
        reason = str(error).splitlines()[0]
        raise UsageError(
            f"NUMBA_THREADING_LAYER={asked}: {reason} Unset it, or set one of {', '.join(LAYERS)}"
        ) from None
    _started_in.setdefault(_layer(), os.getpid())


def _layer():
    try:
        return numba.threading_layer()
    except ValueError:  # the JIT is off
        return "none"


@contextmanager
def computing():
    """Run a block that calls parallel kernels, where the threading layer allows it.

    Numba's work queue serves one Python thread at a time and ends the process where two come: the
    second waits. GNU OpenMP ends a process that was forked after its threads have started, and
    who waits for it waits for ever: UsageError.
    """
    layer = _layer()
    if layer == "omp" and _started_in.get(layer) != os.getpid() and _gnu():
        raise UsageError(
            "this process was forked from one that has started the threads of GNU OpenMP, and "
            "cannot compute: use multiprocessing.get_context('spawn'), or "
            "pip install 'rodsim[fast]'"
        )
    if layer != "workqueue":
        yield
        return
    with _one_at_a_time:
        yield


def _gnu():
    """Tell GNU's OpenMP from others, which may be forked."""
    from numba.np.ufunc import omppool

    return getattr(omppool, "openmp_vendor", "GNU") == "GNU"


@contextmanager
def threads_for(points: int, asked: int | None = None):
    """Run a block with the threads that sums over ``points`` are worth; then restore the setting.

    ``asked`` overrules the choice, up to the number that Numba was started with.
    """
    with computing():
        before = numba.get_num_threads()
        numba.set_num_threads(_choose(points, asked))
        try:
            yield
        finally:
            numba.set_num_threads(before)


def _choose(points, asked):
    most = numba.config.NUMBA_NUM_THREADS
    if asked is not None and asked < 1:
        raise UsageError(f"threads must be 1 or more, not {asked}")
    if asked is not None:
        return min(asked, most)
    enough = WORTHWHILE.get(_layer(), WORTHWHILE["omp"])
    return most if PAIR_SECONDS * points**2 > enough else 1
