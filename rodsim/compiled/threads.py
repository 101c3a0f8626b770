"""How many threads a scene is worth."""

from contextlib import contextmanager

import numba

from rodsim.errors import UsageError

PAIR_SECONDS = 1.5e-9  # one pair of the sums on one core
# A sum must last this long, serial, to be worth sharing out: waking a thread that sleeps in GNU
# OpenMP or in Numba's work queue costs 40-100 us, in tbb 1-2 us.
WORTHWHILE = {"tbb": 3e-5, "omp": 3e-4, "workqueue": 3e-4}


@contextmanager
def threads_for(points: int, asked: int | None = None):
    """Run a block with the threads that sums over ``points`` are worth; then restore the setting.

    ``asked`` overrules the choice, up to the number that Numba was started with.
    """
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
    enough = WORTHWHILE.get(numba.config.THREADING_LAYER, WORTHWHILE["omp"])
    return most if PAIR_SECONDS * points**2 > enough else 1
