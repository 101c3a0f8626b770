"""Kernels as plain Python, where Numba is told to compile nothing."""

import warnings

import numpy as np

from rodsim.compiled.kernels import interpreted, part


@part
def go_around(out):
    """Step from the last point to the first, as along a closed rod."""
    first, last = np.uint64(2), np.uint64(9)
    out[0] = last + (first - last)


def test_unsigned_numbers_wrap_as_in_machine_code_without_a_word(monkeypatch):
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    out = np.zeros(1, np.uint64)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        interpreted(go_around.address, out)
    assert out[0] == 2
