"""Numba's cache as the library meets it: damaged, or impossible."""

import os
import subprocess
import sys

import pytest

from rodsim.compiled.cache import cached_njit, remove_damaged

MODULE = """
from rodsim.compiled.cache import cached_njit

@cached_njit("float64(float64)", error_model="numpy")
def scaled(x):
    return 2.5 * x
"""


def test_files_that_are_cut_off_are_removed_and_no_others(tmp_path):
    whole = b"\x80\x04a pickle."
    for name in ("a.nbi", "a.1.nbc", "b.nbi", "b.1.nbc", "c.nbi", "other.txt"):
        (tmp_path / name).write_bytes(whole)
    (tmp_path / "b.nbi").write_bytes(whole[:-1])
    (tmp_path / "a.1.nbc").write_bytes(b"")
    (tmp_path / "other.txt").write_bytes(b"")
    remove_damaged(tmp_path)
    left = {file.name for file in tmp_path.iterdir()}
    assert left == {"a.nbi", "b.1.nbc", "c.nbi", "other.txt"}


@pytest.mark.compiled
def test_a_cut_off_file_of_the_cache_is_compiled_anew(tmp_path):
    (tmp_path / "kernels.py").write_text(MODULE)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}

    def run():
        return subprocess.run(
            [sys.executable, "-c", "import kernels; print(kernels.scaled(3.0))"],
            cwd=tmp_path, env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip

    assert run().stdout == "7.5\n"
    files = [f for f in (tmp_path / "cache").rglob("*") if f.suffix in (".nbi", ".nbc")]
    assert len(files) == 2
    for file in files:
        os.truncate(file, 10)
        again = run()
        assert (again.stdout, again.stderr) == ("7.5\n", "")


@pytest.mark.compiled
def test_what_cannot_be_kept_is_compiled_for_this_process():
    namespace = {}
    exec(compile("def scaled(x):\n    return 2.5 * x", "/nowhere/at/all.py", "exec"), namespace)
    with pytest.warns(UserWarning, match="set NUMBA_CACHE_DIR to a folder that can be written"):
        kernel = cached_njit("float64(float64)", error_model="numpy")(namespace["scaled"])
    assert kernel(3.0) == 7.5


FACTORY = """
from rodsim.compiled.cache import cached_cfunc, cached_njit

def scaled_by(factor):
    @cached_njit(error_model="numpy")
    def scaled(x):
        y = 0.0
LINES
        return factor * x[0] + 0.0 * y
    return scaled

double, triple = scaled_by(2.0), scaled_by(3.0)

def doubled(x, out):
    out[0] = double(x)

def tripled(x, out):
    out[0] = triple(x)

def made(function):
    return cached_cfunc(function, "void(float64[::1], float64[::1])").address
"""
TOO_LONG_TO_BE_INLINED = "\n".join(" " * 8 + f"y = y * x[1] + x[{i % 3}]" for i in range(99))
CALLED = """
import numpy as np
import kernels
from numba import njit, types
from rodsim.compiled.flags import _jump, intrinsic

@intrinsic
def call_at(typing, address, x, out):
    return types.void(types.int64, x, out), _jump

@njit
def call(address, x, out):
    call_at(address, x, out)

for function in kernels.doubled, kernels.tripled:
    out = np.zeros(1)
    call(kernels.made(function), np.array([7.0, 0.3, 0.2]), out)
    print(out[0])
"""


@pytest.mark.compiled
def test_functions_of_one_factory_that_two_processes_compiled_are_told_apart(tmp_path):
    """Both are the first that their process compiles: the number that Numba gives is the same."""
    (tmp_path / "kernels.py").write_text(FACTORY.replace("LINES", TOO_LONG_TO_BE_INLINED))
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    made = "import kernels; kernels.made(kernels.{})"
    for code in made.format("doubled"), made.format("tripled"), CALLED:
        done = subprocess.run(
            [sys.executable, "-c", code],
            cwd=tmp_path, env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
    assert done.stdout == "14.0\n21.0\n"
