"""What Numba keeps of compiled code: whether it can, and whether what lies there is whole.

A file of its cache that is cut off would end every start in an EOFError. Numba gives a file its
name only when it is whole, so one that does not end as a pickle was damaged since.
"""

import os
import warnings
from contextlib import ExitStack, suppress
from functools import cache, cached_property
from hashlib import sha256
from pathlib import Path

import numba
from numba import njit
from numba.core.caching import FunctionCache, NullCache
from numba.core.ccallback import CFunc
from numba.core.runtime import rtsys
from numba.core.sigutils import normalize_signature

from rodsim.compiled.folder import alone
from rodsim.compiled.settings import without_scipy
from rodsim.errors import FileError

# The versions of Numba whose ways of reading are known well enough to do less; others do as theirs.
KNOWN = (0, 61), (0, 68)
reading = None
if KNOWN[0] <= numba.version_info.short <= KNOWN[1]:
    from rodsim.compiled import reading

END = b"."  # of every pickle
LOCK = ".saving"


class _Cache(FunctionCache):
    """Numba's cache of a function, read without what only compiling needs.

    Before it reads, Numba's own prepares to compile: it looks through all functions and types that
    it knows, which takes longer than to read what a run needs. Who compiles does so again.
    """

    _impl_class = reading.Impl if reading else FunctionCache._impl_class

    def __init__(self, function):
        super().__init__(function)
        if reading:
            stamp = self._impl.locator.get_source_stamp()
            self._cache_file = reading.File(self._cache_path, self._impl.filename_base, stamp)

    def load_overload(self, sig, target_context):
        """Return the compiled function of a signature, None where the cache has none."""
        if reading:
            reading.know_memory()
        else:
            rtsys.initialize(target_context)  # memory of arrays, which the code on the disk calls
        with without_scipy(), self._guard_against_spurious_io_errors():
            try:
                found = self._load_overload(sig, target_context)
            except Exception:  # damaged, or else it fails again
                remove_damaged(Path(self.cache_path))
                found = self._load_overload(sig, target_context)
            if found is None:
                import numba.np.arraymath  # noqa: F401  (who compiles looks for SciPy there)
            return found

    def save_overload(self, sig, data):
        """Save the compiled function of a signature, if no other process has meanwhile.

        One at a time: of two that add to an index at once, what the first has added is lost, or
        both take the same name for the code of two functions.
        """
        with self._guard_against_spurious_io_errors():
            self._impl.locator.ensure_cache_path()
            with ExitStack() as held:
                with suppress(OSError):  # not ours to lock
                    held.enter_context(alone(Path(self.cache_path) / LOCK))
                if not self._holds(self._index_key(sig, data.codegen)):
                    self._save_overload(sig, data)

    def _holds(self, key):
        try:
            return self._cache_file.load(key) is not None
        except Exception:  # damaged: written anew
            return False


class _Late:
    """The cache of a function, made when it is asked for: most are compiled only within others."""

    def __init__(self, function):
        self._function = function

    def __getattr__(self, name):
        return getattr(self._made, name)

    @cached_property
    def _made(self):
        try:
            return _Cache(self._function)
        except RuntimeError:  # Numba has no place to write to
            _warn_once()
            return NullCache()


def cached_njit(*signature, **options):
    """Return Numba's ``njit`` with its cache, or without where nothing can be kept.

    For use as a decorator, with a signature or without.
    """
    if signature and callable(signature[0]):
        return cached_njit(**options)(signature[0])

    def decorate(function):
        made = njit(**options)(_named_apart(function))
        if made is function:  # the JIT is off
            return made
        made._cache = _Late(function)
        for each in signature:
            made.compile(each)
        if signature:
            made.disable_compile()
        return made

    return decorate


def cached_cfunc(function, signature, **options):
    """Return what Numba's ``cfunc`` makes of a function, with its cache, as :func:`cached_njit`."""
    made = CFunc(_named_apart(function), normalize_signature(signature), {}, options)
    made._cache = _Late(function)
    made.compile()
    return made


def _named_apart(function):
    """Give a function that another one has made a name of its own, from what it was made with.

    In machine code a function is known by its name, the types of its arguments and a number that
    counts from 0 in each process. Of two that one factory has made, compiled in two processes and
    read from the cache by a third, LLVM would take the first for both.
    """
    made_with = [_told(cell.cell_contents) for cell in function.__closure__ or ()]
    if made_with:
        digest = sha256(" ".join(made_with).encode()).hexdigest()[:8]
        function.__qualname__ = f"{function.__qualname__}_{digest}"
    return function


def _told(value):
    if isinstance(value, tuple | list):
        return f"({', '.join(map(_told, value))})"
    function = getattr(value, "py_func", value)
    if callable(function) and hasattr(function, "__qualname__"):
        return f"{function.__module__}.{function.__qualname__}"
    return repr(value)


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
