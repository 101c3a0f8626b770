"""Quantities of one's own: ``my.py:function``, a function of a rod at a frame."""

from __future__ import annotations

import importlib.util
from functools import lru_cache
from pathlib import Path

from rodsim.analysis.measures import Measure
from rodsim.analysis.subjects import KINDS
from rodsim.case.words import did_you_mean
from rodsim.errors import UsageError


def own_measure(text: str) -> Measure:
    """Return the quantity that ``FILE.py:FUNCTION`` names; raises UsageError.

    The function is called with each rod at each frame, a ``subjects.RodFrame``, and returns a
    number. The first line of its docstring says what it is. It may have attributes: ``unit``, a
    text such as "um s^-1", and ``per = "scene"`` to be called with a whole ``subjects.Frame``.
    """
    path, _, name = text.rpartition(":")
    found = _module(path)
    function = getattr(found, name, None)
    if not callable(function):
        near = did_you_mean(name, (n for n, v in vars(found).items() if callable(v)))
        raise UsageError(f"{text}: {path} has no function '{name}'{near}")
    per = getattr(function, "per", "rod")
    if per not in KINDS:
        raise UsageError(f"{text}: its 'per' is {per!r}: must be one of {', '.join(KINDS)}")
    about = (function.__doc__ or "").strip().partition("\n")[0] or f"of {path}"
    return Measure(name, about, per, str(getattr(function, "unit", "")), _checked(text, function))


def _module(path):
    if not Path(path).is_file():
        raise UsageError(f"{path}: no such file; a quantity of your own is FILE.py:FUNCTION")
    file = Path(path).resolve()
    return _loaded(file, file.stat().st_mtime_ns)


@lru_cache
def _loaded(path, changed):
    """Return the module in a file; ``changed``: when the file was, so that an edit counts."""
    found = importlib.util.spec_from_file_location(path.stem, path)
    if found is None:
        raise UsageError(f"{path}: is not a file of Python, its name must end in .py")
    module = importlib.util.module_from_spec(found)
    try:
        found.loader.exec_module(module)
    except Exception as error:  # whatever a file of the user's does
        raise UsageError(f"{path}: cannot be loaded: {type(error).__name__}: {error}") from error
    return module


def _checked(text, function):
    def measured(place):
        try:
            return float(function(place))
        except Exception as error:  # whatever a function of the user's does
            reason = f"{type(error).__name__}: {error}"
            where = f"at t = {place.time:g}" + (f" of rod '{n}'" if (n := _name(place)) else "")
            raise UsageError(f"{text}: failed {where}: {reason}") from error

    return measured


def _name(place):
    return getattr(place, "name", "")
