"""Numba's settings for the command. Importing the library never comes here."""

import hashlib
import os
import platform
import sys
from pathlib import Path

import rodsim


def prepare(threads: int | None) -> None:
    """Choose where compiled code is kept and how many threads run; call before Numba is imported.

    The cache lies in the user's own folder, so a read-only install works, under a name made of
    everything compiled code depends on: another version, source, Python or processor finds
    nothing stale there. Variables that the user has set are left alone.
    """
    os.environ.setdefault("NUMBA_CACHE_DIR", str(cache_folder()))
    if threads is not None:
        os.environ["NUMBA_NUM_THREADS"] = str(threads)


def cache_folder() -> Path:
    """Return the folder for compiled code of exactly this installation on this processor."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(home) / "rodsim" / _fingerprint()


def _fingerprint():
    digest = hashlib.sha256(rodsim.__version__.encode())
    for source in sorted(Path(rodsim.__file__).parent.rglob("*.py")):
        digest.update(source.read_bytes())
    digest.update(f"{sys.version} {platform.machine()} {_processor()}".encode())
    return digest.hexdigest()[:16]


def _processor():
    try:
        with open("/proc/cpuinfo") as lines:
            wanted = ("model name", "flags", "Features")
            return sorted({line for line in lines if line.startswith(wanted)})
    except OSError:
        return platform.processor()
