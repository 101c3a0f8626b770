"""Parts: what acts in a scene, each a function of one signature that the loop calls by address.

    part(row, fixed, rods, state, loads, velocities)

row        (n,) its numbers at the time of this evaluation
fixed      (m,) its numbers that never change
rods       the tables of all rods, ``nodes.Rods.tables``
state      position (3, N), director (3, 3, N), tracer (3, P)
loads      (6, N): force g on the fluid in rows 0-2, torque m in rows 3-5
velocities of the rods, u and w (6, N), and of the tracers, u (3, P)

A *force* adds to the loads, a *flow* reads them and adds to the velocities; neither ever sets:
the arrays are clear before the first part. A part does not raise (the call swallows it) and does
not depend on the number of threads.

A *sum* is a function of another signature, the velocities at targets by point loads at sources:

    sum(run, targets, sources, loads, epsilon, viscosity, wall, out)

Parts call it by its address too, so that they are compiled once for every fluid. It shares out the
targets, to threads that call ``run`` (:mod:`rodsim.flows.by_threads`) or to those of a card. And
all that needs velocities at increments calls the one *evaluation* of :mod:`rodsim.scene.loop`.

The loop is compiled once for all scenes, and a part once for all: a scene compiles or loads just
the parts that it lists. Importing this does not import Numba, so that the words of a part in the
case file and its numbers may stand beside its kernel.
"""

from __future__ import annotations

import os
from functools import cached_property, partial
from importlib import import_module

_INTERPRETED: list = []  # parts by number, where the JIT is off


def jit_is_off() -> bool:
    """Tell whether Numba is told to leave all code as it is."""
    return os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")


class Kernel:
    """The function of a part or a sum, compiled when its address is first asked for."""

    def __init__(self, function, signature="PART"):
        self.function, self.signature = function, signature  # its name in ``flags``
        self.__doc__ = function.__doc__

    def __call__(self, *arguments):
        """Run it as plain Python."""
        return self.function(*arguments)

    @property
    def where(self) -> str:
        """Where it is, ``module:name``."""
        return f"{self.function.__module__}:{self.function.__name__}"

    @cached_property
    def address(self) -> int:
        """Where its machine code lies; with the JIT off, its number."""
        if jit_is_off():
            _INTERPRETED.append(self.function)
            return len(_INTERPRETED) - 1
        return self._compiled.address

    @cached_property
    def _compiled(self):
        from rodsim.compiled import flags

        options = {"fastmath": flags.SUM_FLAGS} if self.signature == "RUN" else {}
        return flags.compile_part(self.function, getattr(flags, self.signature), **options)


part = Kernel  # as a decorator
pair_sum = partial(Kernel, signature="SUM")
run_of_sum = partial(Kernel, signature="RUN")
evaluation = partial(Kernel, signature="EVALUATION")


def address_of(kernel: Kernel | str) -> int:
    """Return the address of a part, or of one that is named ``module:name``, imported only now."""
    if isinstance(kernel, str):
        module, _, name = kernel.partition(":")
        kernel = getattr(import_module(module), name)
    return kernel.address


def interpreted(address, *arguments):
    """Call a part or a sum where the JIT is off."""
    _INTERPRETED[address](*arguments)
