"""Compiled functions from the cache: what reading them leaves out, and what it may not."""

import os
import subprocess
import sys

import pytest

KERNELS = """
import numpy as np
from rodsim.compiled.cache import cached_njit

@cached_njit("float64[:, ::1](float64[::1])", error_model="numpy")
def squares(x):
    if x.size % 2:
        raise ValueError("an odd number of squares")
    out = np.empty(x.size)
    for k in range(x.size):
        out[k] = x[k] * x[k]
    return out.reshape(2, x.size // 2)
"""
READ = """
import sys
from rodsim.compiled.settings import prepare
prepare()
import numpy as np
import kernels
from numba.core.runtime import rtsys
assert sum(kernels.squares.stats.cache_hits.values()) == 1
assert "numba.np.arrayobj" not in sys.modules
assert not rtsys._init
print(kernels.squares(np.array([3.0, 5.0, 7.0, 9.0])).tolist())
try:
    kernels.squares(np.zeros(3))
except ValueError as error:
    print(error)
"""
UNKNOWN = """
import numba
numba.version_info = numba.version_info._replace(short=(9, 0))
import numpy as np
import kernels
from numba.core.runtime import rtsys
assert sum(kernels.squares.stats.cache_hits.values()) == 1
assert rtsys._init
print(kernels.squares(np.array([3.0, 5.0, 7.0, 9.0])).tolist())
"""
LINKED = """
import numpy as np
import kernels
from numba import njit

@njit
def doubled(x):
    room = np.empty(x.size)
    for k in range(x.size):
        room[k] = 2.0 * x[k]
    return kernels.squares(room)

print(doubled(np.array([3.0, 5.0, 7.0, 9.0])).tolist())
print(sum(kernels.squares.stats.cache_hits.values()))
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    tmp_path = tmp_path_factory.mktemp("reading")
    (tmp_path / "kernels.py").write_text(KERNELS)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}

    def python(code):
        done = subprocess.run(
            [sys.executable, "-c", code],
            cwd=tmp_path, env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return done.stdout

    python("import kernels")
    return python


@pytest.mark.compiled
def test_what_only_compiling_needs_is_left_out_of_reading(run):
    assert run(READ) == "[[9.0, 25.0], [49.0, 81.0]]\nan odd number of squares\n"


@pytest.mark.compiled
def test_what_was_read_is_linked_into_what_is_compiled(run):
    assert run(LINKED) == "[[36.0, 100.0], [196.0, 324.0]]\n1\n"


@pytest.mark.compiled
def test_a_numba_that_is_not_known_reads_in_its_own_way(run):
    """From a cache of its own, for what is kept differs."""
    assert run("import shutil, os; shutil.rmtree(os.environ['NUMBA_CACHE_DIR'])") == ""
    run(UNKNOWN.split("import numpy")[0] + "import kernels")
    assert run(UNKNOWN) == "[[9.0, 25.0], [49.0, 81.0]]\n"
