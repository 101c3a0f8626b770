"""Threads and processes of those who use the library: each works, or says what to do."""

import os
import subprocess
import sys

import pytest
from scenes import CONFIGS

from rodsim.compiled.settings import load_tbb

SUM = """
import multiprocessing, sys, threading
import numpy as np
import rodsim

points = np.random.default_rng(3).normal(size=(300, 3))

def speed(k):
    return abs(rodsim.velocity(points, points, points + k, points, 0.3, 0.7)[0]).max()

"""
POOL = """
if __name__ == "__main__":
    alone = [speed(k) for k in (2, 3)]
    with multiprocessing.get_context("fork").Pool(2) as pool:
        print(pool.map(speed, [2, 3]) == alone)
"""
TOGETHER = """
alone, found = speed(2), []
workers = [threading.Thread(target=lambda: [found.append(speed(2)) for _ in range(20)])
           for _ in range(4)]
for worker in workers:
    worker.start()
for worker in workers:
    worker.join()
print(found == [alone] * 80)
"""


def python(folder, code, layer):
    (folder / "script.py").write_text(SUM + code)
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_THREADING_LAYER"}
    environment |= {"NUMBA_THREADING_LAYER": layer} if layer else {}
    return subprocess.run(
        [sys.executable, "script.py"],
        cwd=folder, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip


@pytest.mark.compiled
@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
@pytest.mark.skipif(not load_tbb(), reason="needs tbb")
def test_a_pool_that_forks_after_a_sum_works(tmp_path):
    done = python(tmp_path, POOL, "")
    assert done.stdout == "True\n", done.stderr


@pytest.mark.compiled
@pytest.mark.skipif(sys.platform != "linux", reason="GNU OpenMP")
def test_where_it_cannot_the_pool_says_what_to_do(tmp_path):
    """Without the check the children end by a signal, and the pool waits for ever."""
    done = python(tmp_path, POOL, "omp")
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == (
        "rodsim.errors.UsageError: this process was forked from one that has started the threads "
        "of GNU OpenMP, and cannot compute: use multiprocessing.get_context('spawn'), or "
        "pip install 'rodsim[fast]'"
    )


@pytest.mark.compiled
def test_threads_that_compute_together_wait_for_the_work_queue(tmp_path):
    done = python(tmp_path, TOGETHER, "workqueue")
    assert done.stdout == "True\n", done.stderr


@pytest.mark.compiled
def test_an_unknown_threading_layer_is_named(tmp_path):
    done = python(tmp_path, "speed(2)", "foo")
    assert (
        "UsageError: NUMBA_THREADING_LAYER=foo: The threading layer requested 'foo'"
        in (done.stderr.splitlines()[-1])
    )
    environment = {**os.environ, "NUMBA_THREADING_LAYER": "foo"}
    done = subprocess.run(
        [sys.executable, "-m", "rodsim", "info", CONFIGS / "closed_ring.yaml"],
        env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("NUMBA_THREADING_LAYER=foo: there is none; unset it, or set one")
    assert done.stderr.count("\n") == 1
