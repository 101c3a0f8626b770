"""Numba's settings for the command. Importing the library never comes here."""

import atexit
import ctypes
import hashlib
import os
import platform
import shutil
import sys
import tempfile
from contextlib import contextmanager
from functools import cache
from importlib.metadata import version
from pathlib import Path
from zlib import crc32

import rodsim
from rodsim.compiled.folder import private_folder, writable_folder
from rodsim.errors import UsageError

COMPILERS = ("numba", "llvmlite", "numpy")
_not_kept, _prepared = [], []
LAYERS = ("default", "tbb", "omp", "workqueue", "safe", "threadsafe", "forksafe")


def prepare() -> None:
    """Choose the cache of compiled code and the threading layer; call before Numba is imported.

    The cache lies in the user's own folder, so a read-only install works, under a name made of
    everything compiled code depends on: another version, source, Python, Numba or processor finds
    nothing stale there. Variables that the user has set are left alone. Raises UsageError for a
    threading layer that there is not.
    """
    _allow_wide_vectors()
    _choose_cache()
    layer = os.environ.get("NUMBA_THREADING_LAYER", "tbb")
    if layer not in LAYERS:
        raise UsageError(
            f"NUMBA_THREADING_LAYER={layer}: there is none; unset it, or set one of "
            + ", ".join(LAYERS)
        )
    if layer == "tbb":
        os.environ["NUMBA_THREADING_LAYER"] = "tbb" if load_tbb() else "default"
    _let_llvm_vectorise()
    # GNU OpenMP's idle threads spin: with a busy neighbour each sum then takes milliseconds.
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    _prepared.append(True)
    with without_scipy():
        import numba  # noqa: F401


def _allow_wide_vectors():
    """Let LLVM use vectors of 512 bits where there are any: on Intel's processors it stops at 256.

    The sums have them anyway (``wide.py``); this is for all other kernels.
    """
    import llvmlite.binding

    try:
        features = llvmlite.binding.get_host_cpu_features()
    except RuntimeError:  # LLVM does not know them on every system
        return
    if features.get("avx512f") and not {"NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"} & set(os.environ):
        os.environ["NUMBA_CPU_FEATURES"] = f"{features.flatten()},-prefer-256-bit"


@contextmanager
def without_scipy():
    """Let Numba not find SciPy while it is imported, once ``prepare`` was called.

    It looks for SciPy's version and BLAS, for products of matrices in kernels. Ours have none, and
    where SciPy is installed its import takes a third of the time to start.
    """
    if "scipy" in sys.modules or not _prepared:
        yield
        return
    sys.modules["scipy"] = None
    try:
        yield
    finally:
        del sys.modules["scipy"]


def _let_llvm_vectorise():
    """Allow as many alias checks before a loop as elasticity and rotations need.

    Their loops read some twenty rows and write nine; LLVM gives up at 128 checks by default. The
    results are the same bits, at a third of the time.
    """
    import llvmlite.binding

    llvmlite.binding.set_option("rodsim", "-vectorize-memory-check-threshold=2000")


def _choose_cache():
    """Set the folder of compiled code, if the user has not; remember why it will not last."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    try:
        folder = writable_folder(Path(given)) if given else private_folder(cache_folder())
        os.environ["NUMBA_CACHE_DIR"] = str(folder)
    except OSError as error:
        _not_kept.append(f"{error.filename or given or cache_folder()}: {error.strerror}")
        if not given:
            _use_temporary_folder()


def _use_temporary_folder():
    """Keep compiled code for this process and those that it starts."""
    try:
        own = tempfile.mkdtemp(prefix="rodsim-")
    except OSError:  # not even that: Numba then compiles without a cache
        return
    os.environ["NUMBA_CACHE_DIR"] = own
    atexit.register(shutil.rmtree, own, ignore_errors=True)


def why_not_kept() -> str:
    """Return why compiled code is lost at the end of this process; empty if it is not."""
    return _not_kept[-1] if _not_kept else ""


def cache_folder() -> Path:
    """Return the folder for compiled code of exactly this installation on this processor."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(home) / "rodsim" / fingerprint()


def load_tbb() -> bool:
    """Load the library of ``pip install tbb``: Numba itself does not look where pip puts it."""
    folder = Path(sys.prefix) / ("Library/bin" if os.name == "nt" else "lib")
    for name in ("libtbb.so.12", "libtbb.12.dylib", "tbb12.dll"):
        try:
            ctypes.CDLL(str(folder / name), mode=ctypes.RTLD_GLOBAL)
        except OSError:
            continue
        return True
    return False


@cache
def fingerprint() -> str:
    """Return a name for this installation: its place (Numba's cache has it), source, processor."""
    digest = hashlib.sha256(f"{rodsim.__version__} {rodsim.__file__}".encode())
    for source in sorted(Path(rodsim.__file__).parent.rglob("*.py")):
        digest.update(source.read_bytes())
    versions = [version(name) for name in COMPILERS]
    asked = [os.environ.get(name) for name in ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES")]
    digest.update(f"{versions} {sys.version} {platform.machine()} {_processor()} {asked}".encode())
    return digest.hexdigest()[:16]


@cache
def machine() -> dict[str, str]:
    """Return what the last bits of a result depend on: versions, and what the code is made for.

    The processor as LLVM sees it, its name and a digest of its features.
    """
    import llvmlite.binding

    try:
        found = f"{llvmlite.binding.get_host_cpu_features().flatten()}"
    except RuntimeError:  # LLVM does not know them on every system
        found = ""
    name = os.environ.get("NUMBA_CPU_NAME") or llvmlite.binding.get_host_cpu_name()
    features = os.environ.get("NUMBA_CPU_FEATURES") or found
    processor = f"{name[:22]} {crc32(features.encode()):08x}"
    return {each: version(each) for each in COMPILERS} | {"processor": processor}


def _processor():
    try:
        with open("/proc/cpuinfo") as lines:
            wanted = ("model name", "flags", "Features")
            return sorted({line for line in lines if line.startswith(wanted)})
    except OSError:
        return platform.processor()
