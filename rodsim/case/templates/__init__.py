"""Commented cases to start from, as files; the paper's three scenes, shortened."""

from __future__ import annotations

from importlib import resources

from rodsim.case.words import did_you_mean, one_of
from rodsim.errors import UsageError

TEMPLATES = ("open", "ring", "flagellum")


def template(name: str) -> str:
    """Return the text of a commented case: ``open``, ``ring`` or ``flagellum``."""
    if name not in TEMPLATES:
        hint = did_you_mean(name, TEMPLATES)
        raise UsageError(f"no case called '{name}': there is {one_of(TEMPLATES)}{hint}")
    return resources.files(__name__).joinpath(f"{name}.yaml").read_text(encoding="utf-8")
