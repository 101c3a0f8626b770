"""The folder of a run, made of the values that are its own."""

from __future__ import annotations

import hashlib
import json
import re

LONGEST_NAME = 120  # of a folder
WHOLE = 2.0**53  # below it a float that is whole is that integer


def folder_name(values: dict) -> str:
    """Return a name such as ``b=0.5_sigma=400``, as readable as the values allow.

    Values that are the same make the same name, 1 and 1.0, and others another one, also on disks
    that do not tell capitals from small letters.
    """
    last = [key.rpartition(".")[2] for key in values]
    texts = [value_text(value) for value in values.values()]
    words = [
        f"{short if last.count(short) == 1 else key}={text}"
        for short, key, text in zip(last, values, texts, strict=True)
    ]
    name = "_".join(words) or "run"
    safe = re.sub(r"[^A-Za-z0-9.,=+_-]+", "-", name)[:LONGEST_NAME]
    if safe == name and all(text == text.lower() for text in texts):
        return name
    return f"{safe}-{hashlib.sha256(name.encode()).hexdigest()[:8]}"


def value_text(value) -> str:
    """Return a value as a short text."""
    if isinstance(value, list):
        return ",".join(map(value_text, value))
    return value if isinstance(value, str) else json.dumps(_plain(value))


def _plain(value):
    """Return a value in which whole numbers are integers, however they were written."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    whole = isinstance(value, float) and value.is_integer() and abs(value) < WHOLE
    return int(value) if whole else value
