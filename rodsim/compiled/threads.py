"""Numba's threads: started once, as many as a scene is worth, and what they cannot do."""

import os
import threading
from contextlib import contextmanager

import numba

from rodsim.compiled.settings import LAYERS, load_tbb
from rodsim.errors import UsageError

PAIR_SECONDS = 2e-9  # one pair of the sums on one core
PLANAR, WITHOUT_W, AT_WALL = 0.5, 0.55, 2.0  # a pair of other sums, in such pairs: measured too
# What each of several threads adds to a sum: waking one that sleeps in GNU OpenMP or in Numba's
# work queue costs far more than in tbb. Measured, docs/notes/performance.md.
LAUNCH_SECONDS = {"tbb": 2.5e-6, "omp": 8e-5, "workqueue": 8e-5}
NO_GAIN = 1.1  # what less time than this would save is not worth more threads
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
def threads_for(pairs: float, asked: int | None = None):
    """Run a block with the threads that sums over ``pairs`` are worth; then restore the setting.

    ``asked`` overrules the choice, up to the number that Numba was started with.
    """
    with computing():
        before = numba.get_num_threads()
        numba.set_num_threads(_choose(pairs, asked))
        try:
            yield
        finally:
            numba.set_num_threads(before)


def _choose(pairs, asked):
    most = numba.config.NUMBA_NUM_THREADS
    if asked is not None and asked < 1:
        raise UsageError(f"threads must be 1 or more, not {asked}")
    if asked is not None:
        return min(asked, most)
    return threads_worth(PAIR_SECONDS * pairs, _layer(), most)


def pairs_worth(points: int, tracers: int, planar: bool, at_wall: bool) -> float:
    """Return how many pairs of the sums in space take the time of a scene's sums.

    Tracers need no w, a pair in a plane is half the work, a wall has an image of each source.
    """
    targets = points * (PLANAR if planar else 1.0) + tracers * WITHOUT_W
    return points * targets * (AT_WALL if at_wall else 1.0)


def threads_worth(serial: float, layer: str, most: int) -> int:
    """Return how many threads a sum is worth that takes ``serial`` seconds on one, up to ``most``.

    On n > 1 it takes serial/n + n launch. The fewest count that come within a tenth of the best:
    others can use the rest, and no number is chosen that is slower than a smaller one.
    """
    launch = LAUNCH_SECONDS.get(layer, LAUNCH_SECONDS["omp"])
    seconds = [serial, *(serial / n + n * launch for n in range(2, most + 1))]
    best = min(seconds)
    return next(n for n, each in enumerate(seconds, 1) if each <= NO_GAIN * best)
