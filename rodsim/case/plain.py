"""Cases and overrides as Python gives them: numbers of NumPy, tuples, paths become plain data."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from typing import Any

from rodsim.errors import UsageError


def plain(value: Any) -> Any:
    """Return data with dicts, lists and Python's own numbers and texts alone.

    Numbers and arrays of NumPy, tuples, other mappings and paths are turned into these; what else
    there is stays, for the model to refuse.
    """
    if isinstance(value, Mapping):
        return {_key(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):  # an array or a number of NumPy
        return plain(value.tolist())
    return value


def override_texts(overrides: Mapping[str, Any] | Iterable[str]) -> tuple[str, ...]:
    """Return overrides as ``key=value`` texts: a list of such, or a mapping of keys to values.

    Raises UsageError for what is neither.
    """
    if isinstance(overrides, Mapping):
        return tuple(f"{_key(key)}={_text(key, value)}" for key, value in overrides.items())
    texts = () if isinstance(overrides, str) else tuple(overrides)
    if isinstance(overrides, str) or not all(isinstance(text, str) for text in texts):
        raise UsageError(
            'overrides must be texts in a list, such as ["time.end=0.01"], or a dict, such as '
            '{"time.end": 0.01}'
        )
    return texts


def _key(key):
    if not isinstance(key, str):
        raise UsageError(f"the keys of a case are texts, not {key!r}")
    return key


def _text(key, value):
    try:
        return json.dumps(plain(value))
    except (TypeError, ValueError) as error:
        raise UsageError(f"overrides: {key}: {error}") from error
