"""The cache of compiled code as whole commands meet it: broken, emptied, shared."""

import os
import shutil
import subprocess
import sys

import h5py
import pytest
from scenes import CONFIGS

from rodsim.compiled.settings import fingerprint
from rodsim.run.warmup import LIST, note_compiled

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


@pytest.fixture
def broken(tmp_path):
    """Return a cache like that of this process, half of its files cut off since."""
    import rodsim.run.machine  # noqa: F401  (what is not in the cache of this process comes there)

    cache = tmp_path / "cache" / "rodsim" / fingerprint()
    shutil.copytree(os.environ["NUMBA_CACHE_DIR"], cache)
    (cache / LIST).unlink(missing_ok=True)
    note_compiled(cache, f"{fingerprint()}-algebraic7-0-0")
    for file in sorted(cache.rglob("*.nb?"))[::2]:
        os.truncate(file, 100)
    return cache


def written(cache):
    return {file: file.stat().st_mtime_ns for file in cache.rglob("*.nb?")}


@pytest.mark.long
@pytest.mark.compiled
def test_runs_that_meet_a_broken_cache_together_compile_it_anew(tmp_path, broken):
    before = written(broken)
    together = [start(tmp_path, name) for name in ("a.h5", "b.h5")]
    said = [run.communicate()[1] for run in together]
    assert [run.returncode for run in together] == [0, 0], said
    assert COMPILING in said[0] + said[1]
    compiled = written(broken)
    assert len(compiled) > 10
    assert not compiled.items() & before.items()
    warm = start(tmp_path, "c.h5")
    assert COMPILING not in warm.communicate()[1]
    assert len({positions(tmp_path / name) for name in ("a.h5", "b.h5", "c.h5")}) == 1
    assert written(broken) == compiled
