"""Reads compiled functions from Numba's cache without what only compiling needs.

With each function Numba reads the bitcode of all that it calls, to link it into others, imports the
modules whose functions that are, and compiles the routines of its memory. A run that finds all its
kernels on the disk needs none of it, and it takes most of the time of reading them.
"""

import pickle
from functools import cache, partial

from llvmlite import binding
from numba.core import environment
from numba.core.caching import CompileResultCacheImpl, IndexDataCacheFile
from numba.core.runtime import _nrt_python

OBJECT = "object"  # the kind of library that is code


class Impl(CompileResultCacheImpl):
    """Turns a compiled function into what is kept of it, and back."""

    def reduce(self, compiled):
        """Return what Numba keeps, and the names that the code defines."""
        (name, kind, data), *rest = super().reduce(compiled)
        module = binding.parse_bitcode(data[1]) if kind == OBJECT else None
        return (name, kind, data, module and _defined(module)), *rest

    def rebuild(self, target_context, kept):
        """Return the compiled function; its bitcode is looked at by who links it into another."""
        (name, kind, data, *names), *rest = kept
        if kind != OBJECT or not names:
            return super().rebuild(target_context, ((name, kind, data), *rest))
        code, bitcode = data
        target_context.codegen()._engine._defined_symbols |= names[0]
        found = super().rebuild(target_context, ((name, kind, (code, _nothing())), *rest))
        found.library._get_module_for_linking = cache(partial(binding.parse_bitcode, bitcode))
        return found


class File(IndexDataCacheFile):
    """The files of a function in the cache."""

    def _load_data(self, name):
        with open(self._data_path(name), "rb") as file:
            return _Unpickler(file).load()


class _Unpickler(pickle.Unpickler):
    def find_class(self, module, name):
        found = super().find_class(module, name)
        return _environment if found is environment._rebuild_env else found


def _environment(module, constants, name):
    """Return the environment of a function; of one of Numba's without its module.

    What is looked up in that is asked by code that was left to Python, and there is none.
    """
    known = environment.lookup_environment(name)
    if known is not None or not module.startswith("numba."):
        return known or environment._rebuild_env(module, constants, name)
    made = environment.Environment({"__name__": module})
    made.consts[:], made.env_name = constants, name
    environment.Environment._memo[name] = made
    return made


@cache
def know_memory() -> None:
    """Tell LLVM where the routines in C are that manage the memory of arrays."""
    for name, address in _nrt_python.c_helpers.items():
        binding.add_symbol(name if name.startswith("_") else f"NRT_{name}", address)


@cache
def _nothing():
    return binding.parse_assembly("").as_bitcode()


def _defined(module):
    symbols = (*module.functions, *module.global_variables)
    return {symbol.name for symbol in symbols if not symbol.is_declaration}
