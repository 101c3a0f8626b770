"""Shared by all tests: the twins are importable, and tests that need the JIT say so.

What many processes of the tests need is made once: compiled code that importing the tests takes,
and the bytecode of rodsim where Python is told to write none beside the source.
"""

import os
import sys
from pathlib import Path

import pytest

from rodsim.compiled.settings import prepare

prepare()  # threads and cache as the command has them; before Numba is imported

import numba  # noqa: E402

sys.path.insert(0, str(Path(__file__).parent))
sys.path.append(str(Path(__file__).parent.parent / "benchmarks"))  # the rival, and the theory

# Modules that compile when they are imported.
AHEAD = (
    "rodsim.blocks.springs",
    "rodsim.flows.carried",
    "rodsim.flows.fast.plan",
    "rodsim.forces.repulsion",
    "rodsim.forces.surfaces",
    "rodsim.rest.differences",
)


def pytest_configure(config):
    """Compile in two processes, before the whole suite, what each worker would for itself."""
    of_a_worker = hasattr(config, "workerinput")
    if not of_a_worker and sys.dont_write_bytecode and "NUMBA_CACHE_DIR" in os.environ:
        # commands that tests start would compile all of rodsim to bytecode, each anew
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
        os.environ["PYTHONPYCACHEPREFIX"] = f"{os.environ['NUMBA_CACHE_DIR']}/bytecode"
    whole = config.args_source is config.ArgsSource.TESTPATHS
    if whole and not of_a_worker and config.getoption("numprocesses", None):
        from rodsim.run.warmup import ensure

        names = {*AHEAD, *shipped_kernels()}
        ensure(names, lambda line: print(line, file=sys.__stderr__), "the tests")


def shipped_kernels():
    """Return the kernels of the scenes that are shipped, and so of most scenes of tests.

    Each command that a test calls would start a process of its own for those it is the first to
    need.
    """
    from scenes import CONFIGS

    from rodsim.case import load_case
    from rodsim.scene.build import build_scene

    scenes = [build_scene(load_case(path)) for path in sorted(CONFIGS.glob("*.yaml"))]
    return {
        where
        for scene in scenes
        for part in scene.parts
        for where in (part.where, *part.sums, *part.needs)
    }


def pytest_collection_modifyitems(config, items):
    chosen = config.getoption("-m")
    for item in items:
        for mark in ("long", "paper"):
            if item.get_closest_marker(mark) and mark not in chosen:
                item.add_marker(pytest.mark.skip(reason=f"takes minutes: pytest -m {mark}"))
        if "compiled" in item.keywords and numba.config.DISABLE_JIT:
            item.add_marker(pytest.mark.skip(reason="needs compiled kernels"))


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty folder that is the current one."""
    monkeypatch.chdir(tmp_path)
    return tmp_path
