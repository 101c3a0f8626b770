"""What Numba keeps of compiled code: whether it can, and whether what lies there is whole.

A file of its cache that is cut off ends every start in an EOFError. Numba gives a file its name
only when it is whole, so one that does not end as a pickle was damaged since.
"""

import os
import warnings
from functools import cache
from pathlib import Path

import numba
from numba import njit
from numba.core.caching import FunctionCache
from numba.core.ccallback import CFunc
from numba.core.runtime import rtsys
from numba.core.sigutils import normalize_signature

from rodsim.compiled.settings import without_scipy
from rodsim.errors import FileError

END = b"."  # of every pickle


class _Cache(FunctionCache):
    """Numba's cache of a function, read without what only compiling needs.

    Before it reads, Numba's own prepares to compile: it looks through all functions and types that
    it knows, which takes longer than to read what a run needs. Who compiles does so again.
    """

    def load_overload(self, sig, target_context):
        """Return the compiled function of a signature, None where the cache has none."""
        rtsys.initialize(target_context)  # memory of arrays, which the code on the disk calls
        with without_scipy(), self._guard_against_spurious_io_errors():
            found = self._load_overload(sig, target_context)
            if found is None:
                import numba.np.arraymath  # noqa: F401  (who compiles looks for SciPy there)
            return found


def cached_njit(*signature, **options):
    """Return Numba's ``njit`` with its cache, or without where nothing can be kept.

    For use as a decorator, with a signature or without.
    """
    if signature and callable(signature[0]):
        return cached_njit(**options)(signature[0])

    def decorate(function):
        made = njit(**options)(function)
        if made is function:  # the JIT is off
            return made
        if keeps(function):
            made._cache = _Cache(function)
        for each in signature:
            made.compile(each)
        if signature:
            made.disable_compile()
        return made

    return decorate


def cached_cfunc(function, signature, **options):
    """Return what Numba's ``cfunc`` makes of a function, with its cache, as :func:`cached_njit`."""
    made = CFunc(function, normalize_signature(signature), {}, options)
    if keeps(function):
        made._cache = _Cache(function)
    made.compile()
    return made


_seen: dict[str, bool] = {}


def keeps(function) -> bool:
    """Tell whether compiled code of a function's folder can be kept, once that is mended."""
    room = os.path.dirname(function.__code__.co_filename)
    if room not in _seen:
        _seen[room] = numba.config.DISABLE_JIT or _mended(function)
    return _seen[room]


def _mended(function):
    try:
        folder = njit(cache=True)(function).stats.cache_path  # all functions of a room are there
    except RuntimeError:  # Numba has no place to write to
        _warn_once()
        return False
    remove_damaged(Path(folder))
    return True


def remove_damaged(folder: Path) -> None:
    """Remove the files of a cache that are not whole; FileError where that cannot be done."""
    for file in [*folder.glob("*.nbi"), *folder.glob("*.nbc")]:
        try:
            if not _whole(file):
                file.unlink(missing_ok=True)
        except FileNotFoundError:
            continue  # another process was faster
        except OSError as error:
            raise FileError(
                f"{file}: damaged file of Numba's cache, which cannot be removed: "
                f"{error.strerror}; remove it, or set NUMBA_CACHE_DIR to a folder of your own"
            ) from None


def _whole(file):
    with file.open("rb") as stream:
        size = stream.seek(0, os.SEEK_END)
        stream.seek(max(0, size - 1))
        return stream.read() == END


@cache
def _warn_once():
    warnings.warn(
        "compiled code cannot be kept, so every start compiles it anew: set NUMBA_CACHE_DIR to a "
        "folder that can be written",
        stacklevel=2,
    )


def save_in_turn(lock) -> None:
    """Let Numba save nothing but under ``lock()``, and nothing that is there by then.

    Two processes that compile at once would else both add to an index, and what the first has
    added is lost, or take the same name for the code of two functions.
    """
    from numba.core.caching import Cache

    save = Cache.save_overload

    def save_overload(cache, signature, compiled):
        with lock():
            if not _has(cache, signature, compiled):
                save(cache, signature, compiled)

    Cache.save_overload = save_overload


def _has(cache, signature, compiled):
    try:
        key = cache._index_key(signature, compiled.codegen)
        return cache._cache_file.load(key) is not None
    except Exception:  # damaged, or another Numba's: written anew
        return False
