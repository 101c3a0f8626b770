"""Where a case came from: turns key paths into file:line, values and units for messages."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, field
from typing import Any

from rodsim.case.fields import ANGLES, DIMENSIONS
from rodsim.case.places import Place
from rodsim.case.words import clipped, dotted, shown
from rodsim.case.yaml_text import Lines, Path
from rodsim.errors import Problem
from rodsim.files import DEFAULT_OUTPUT
from rodsim.units import unit_text

OVERRIDE = "--set"


@dataclass
class Source:
    """A case file as read: ``lines`` has None for what an override has set."""

    path: str = "case"
    text: str = ""
    overrides: tuple[str, ...] = ()
    data: Any = None
    lines: Lines = field(default_factory=dict)
    root: Place | None = None  # what the model knows; None knows nothing
    numbers: dict[Path, float] = field(default_factory=dict)  # what expressions came to
    added: list[str] = field(default_factory=list)  # parameters that only an override has
    origins: dict[str, str] = field(default_factory=dict)  # what a rod is like, or a copy of

    def where(self, path: Path) -> str:
        """Return ``file:line`` of a key, or of the mapping it would be in, or ``--set``."""
        for end in range(len(path), -1, -1):
            if path[:end] in self.lines:
                line = self.lines[path[:end]]
                return OVERRIDE if line is None else f"{self.path}:{line}"
        return self.path

    def value(self, path: Path) -> Any:
        """Return what the file has at a path, or None."""
        node = self.data
        for part in path:
            node = child(node, part)
        return node

    def place(self, path: Path) -> Place | None:
        """Return what the model expects at a path, or None where it has no such key."""
        place, node = self.root, self.data
        for part in path:
            place = place and place.child(part, node)
            node = child(node, part)
        return place

    def unit(self, path: Path) -> str:
        """Return the unit a number at this path is read in, in the case's own unit names."""
        place = self.place(path)
        if place is None or not place.dimension or isinstance(self.value(path), dict | list):
            return ""
        if place.dimension in ANGLES:
            return ANGLES[place.dimension]
        names = {}
        for name in ("length", "mass", "time", "force"):
            given = self.value(("units", name))
            names[name] = clipped(given) if isinstance(given, str) else self._default_unit(name)
        return unit_text(DIMENSIONS[place.dimension], names)

    def _default_unit(self, name: str) -> str:
        return self.root.child("units").child(name).default

    def number(self, key_path: str, value: Any) -> Any:
        """Return the number that the expression at a key came to; ``value`` where there is none."""
        return self.numbers.get(_path(key_path), value)

    def problem(self, key_path: str | Path, reason: str) -> Problem:
        """Return a Problem at a key: its place, its value, and its unit if it is a number."""
        path = _path(key_path)
        value, unit = shown(self.value(path)), self.unit(path)
        if path in self.numbers:
            value = f"{value} (= {self.numbers[path]:.6g})"
        return Problem(self.where(path), dotted(path), value, reason, unit)

    def command(self, *changes: str, output: str = DEFAULT_OUTPUT) -> str:
        """Return the command that runs this case with other ``--set`` changes, for messages.

        A change takes the place of an earlier one of the same key.
        """
        path = shlex.quote(self.path) if self.text else "CASE.yaml"  # else it has no file
        settings = {text.partition("=")[0].strip(): text for text in (*self.overrides, *changes)}
        words = [f"--set {shlex.quote(text)}" for text in settings.values()]
        words += [f"-o {shlex.quote(output)}"] if output != DEFAULT_OUTPUT else []
        return " ".join(["rodsim run", path, *words])


def _path(key_path: str | Path) -> Path:
    parts = key_path.split(".") if isinstance(key_path, str) else key_path
    return tuple(int(p) if isinstance(p, str) and p.isdecimal() else p for p in parts)


def child(node: Any, part: str | int) -> Any:
    """Return the entry of a mapping or list, or None where there is none."""
    if isinstance(node, dict):
        return node.get(part)
    if isinstance(node, list) and isinstance(part, int) and -len(node) <= part < len(node):
        return node[part]
    return None
