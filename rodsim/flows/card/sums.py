"""The sums on the card as others call them: with arrays of the CPU, by address or from Python.

An address is all that a part needs to call a sum. Here it is that of a callback into Python, which
copies sources to the card, starts the kernels and adds what they find: some 50 us beside copies.
Arrays on the card, and those of the CPU through which copies go, stay from call to call.
"""

import ctypes
import threading
import warnings
from functools import cached_property, lru_cache

import numpy as np
from numba import cuda

from rodsim.compiled.kernels import Kernel
from rodsim.errors import UsageError
from rodsim.flows.blobs import ALGEBRAIC7, ALGEBRAIC9
from rodsim.flows.card.kernels import THREADS, add_parts, share_kernel, shares_of
from rodsim.flows.free import EIGHT_PI

# Compiled code hands over an array as nine numbers (owner, parent, items, item size, address, two
# lengths, two strides), each where C has an argument.
ARRAY = (*[ctypes.c_void_p] * 2, *[ctypes.c_int64] * 2, ctypes.c_void_p, *[ctypes.c_int64] * 4)
CALLBACK = ctypes.CFUNCTYPE(None, ctypes.c_int64, *3 * ARRAY, *3 * [ctypes.c_double], *ARRAY)

_one_at_a_time = threading.Lock()
_failures: list[BaseException] = []


class CardSum(Kernel):
    """A sum on the card, as in :mod:`rodsim.compiled.kernels`; ``run`` is not used."""

    def __init__(self, at_wall: bool, blob: int, planar: bool = False, angular: bool = True):
        super().__init__(self._add_safely, "SUM")
        self.choice = at_wall, blob, planar, angular

    @cached_property
    def _compiled(self):
        return _Callback(self._add_safely)

    def _add_safely(self, run, *arguments):
        """Add to ``out``; what goes wrong makes it NaN and is kept for :func:`failed`."""
        try:
            self.add(*arguments)
        except BaseException as error:
            _failures.append(error)
            arguments[-1][:] = np.nan

    def add(self, targets, sources, loads, epsilon, viscosity, wall, out) -> None:
        """Add u, and w where ``out`` has six rows, at targets (3, T) by loads (6, N) at sources."""
        if not targets.size or not sources.size:
            return
        with _one_at_a_time:
            room = room_of(self.choice, targets.shape[1], sources.shape[1])
            room.start(room.bring(targets, sources, loads), epsilon, viscosity, wall)
            out += room.sums.copy_to_host(room.found)


class _Callback:
    """A function of arrays that compiled code calls by its ``address``."""

    def __init__(self, function):
        self._function = function
        self._c = CALLBACK(self._call)  # lives as long as its address is known
        self.address = ctypes.cast(self._c, ctypes.c_void_p).value

    def _call(self, run, *numbers):
        arrays = [_array(numbers[begin : begin + 9]) for begin in (0, 9, 18, 30)]
        self._function(run, *arrays[:3], *numbers[27:30], arrays[3])


def _array(numbers):
    """Return the array (n, m) that nine numbers describe; it is C-contiguous."""
    n, m = numbers[5:7]
    if n * m == 0:
        return np.zeros((n, m))
    return np.frombuffer((ctypes.c_double * (n * m)).from_address(numbers[4])).reshape(n, m)


class _Room:
    """The arrays of a sum of some size, and how its kernels are started."""

    def __init__(self, choice, targets, sources):
        shares, rows = shares_of(targets, sources), 6 if choice[3] else 3
        self.grid, self._kernel = (-(-targets // THREADS), shares), share_kernel(*choice)
        with warnings.catch_warnings():  # few blocks: each launch is known from then on
            warnings.simplefilter("ignore")
            _ = self._kernel[self.grid, THREADS], add_parts[self.grid[0], THREADS]
        self._sent, self._sources = cuda.pinned_array((9, sources)), cuda.device_array((9, sources))
        self._targets = cuda.device_array((3, targets))
        self.parts = cuda.device_array((shares, rows, targets))
        self.sums = cuda.device_array((rows, targets))
        self.found = cuda.pinned_array((rows, targets))

    def bring(self, targets, sources, loads):
        """Copy what a sum is made of to the card; return targets and sources there."""
        self._sent[:3], self._sent[3:] = sources, loads
        self._sources.copy_to_device(self._sent)
        if targets.shape == sources.shape and targets.ctypes.data == sources.ctypes.data:
            return self._sources, self._sources
        self._targets.copy_to_device(targets)
        return self._targets, self._sources

    def start(self, there, epsilon, viscosity, wall):
        """Start the kernels on what :meth:`bring` has returned; they fill ``sums``."""
        self._kernel[self.grid, THREADS](*there, epsilon, wall, self.parts)
        add_parts[self.grid[0], THREADS](self.parts, 1.0 / (EIGHT_PI * viscosity), self.sums)


@lru_cache(maxsize=16)
def room_of(choice: tuple, targets: int, sources: int) -> _Room:
    """Return the arrays of sums of one size."""
    return _Room(choice, targets, sources)


def failed() -> None:
    """Raise what has gone wrong in a sum that was called by address, where nothing can be raised.

    Whatever the card or its driver say becomes a UsageError.
    """
    if not _failures:
        return
    error = _failures[0]
    _failures.clear()
    if isinstance(error, Exception):
        raise UsageError(
            f"the card failed: {type(error).__name__}: {error}; rodsim resume goes on with a run, "
            "with --device cpu on the CPU"
        ) from error
    raise error


spatial_7, spatial_9 = (CardSum(False, blob) for blob in (ALGEBRAIC7, ALGEBRAIC9))
planar_7, planar_9 = (CardSum(False, blob, planar=True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
flow_7, flow_9 = (CardSum(False, blob, angular=False) for blob in (ALGEBRAIC7, ALGEBRAIC9))
wall_spatial_7, wall_spatial_9 = (CardSum(True, blob) for blob in (ALGEBRAIC7, ALGEBRAIC9))
wall_planar_7, wall_planar_9 = (CardSum(True, blob, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
wall_flow_7, wall_flow_9 = (CardSum(True, blob, False, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))
