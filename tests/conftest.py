"""Shared by all tests: the twins are importable, and tests that need the JIT say so."""

import sys
from pathlib import Path

import pytest

from rodsim.compiled.settings import prepare

prepare()  # threads and cache as the command has them; before Numba is imported

import numba  # noqa: E402

sys.path.insert(0, str(Path(__file__).parent))
sys.path.append(str(Path(__file__).parent.parent / "benchmarks"))  # the rival, and the theory


def pytest_collection_modifyitems(config, items):
    chosen = config.getoption("-m")
    for item in items:
        for mark in ("long", "paper"):
            if item.get_closest_marker(mark) and mark not in chosen:
                item.add_marker(pytest.mark.skip(reason=f"takes minutes: pytest -m {mark}"))
        if "compiled" in item.keywords and numba.config.DISABLE_JIT:
            item.add_marker(pytest.mark.skip(reason="needs compiled kernels"))
