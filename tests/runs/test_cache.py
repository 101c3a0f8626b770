"""The cache of compiled code as whole commands meet it: empty, shared, broken."""

import os
import subprocess
import sys

import h5py
import pytest
from scenes import CONFIGS

COMPILING = "compiling for this kind of scene"


def start(folder, name):
    """Start a short run with a cache in a folder."""
    environment = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache")}
    environment.pop("NUMBA_CACHE_DIR", None)
    command = ["run", CONFIGS / "closed_ring.yaml", "-o", folder / name,
               "--set", "rods.ring.shape.points=40", "--set", "time.end=1e-3"]  # fmt: skip
    return subprocess.Popen(
        [sys.executable, "-m", "rodsim", *map(str, command)],
        env=environment, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def positions(path):
    with h5py.File(path) as file:
        return file["particles/trajectory/position/value"][-1].tobytes()


@pytest.mark.compiled
def test_runs_that_start_together_compile_once_and_a_broken_cache_is_compiled_anew(tmp_path):
    together = [start(tmp_path, name) for name in ("a.h5", "b.h5")]
    said = [run.communicate()[1] for run in together]
    assert [run.returncode for run in together] == [0, 0], said
    compiled = list((tmp_path / "cache").rglob("*.nb?"))
    for file in compiled[::2]:
        os.truncate(file, 100)
    again = start(tmp_path, "c.h5")
    assert COMPILING in again.communicate()[1]
    assert again.returncode == 0
    warm = start(tmp_path, "d.h5")
    assert COMPILING not in warm.communicate()[1]
    assert len({positions(tmp_path / name) for name in ("a.h5", "b.h5", "c.h5", "d.h5")}) == 1
    assert {*(tmp_path / "cache").rglob("*.nb?")} == {*compiled}
