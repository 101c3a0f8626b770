"""``like`` and ``repeat``: rods that are written as others -> rods that say all by themselves.

Done on the data of the file, before the model sees it. Each key keeps the line it was written on,
in the rod itself or in the one it is like.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass, field
from typing import Any

from rodsim.case.expressions import ExpressionError
from rodsim.case.parameters import Scope
from rodsim.case.places import Place
from rodsim.case.source import Source, child
from rodsim.case.words import circle, clipped, did_you_mean, one_of
from rodsim.case.yaml_text import Lines, Path
from rodsim.errors import Problem

RODS = ("rods",)
NUMBER = "i"  # of a copy, in its expressions
MOST_RODS = 10_000
MOST_KEYS = 500_000  # of all rods, written out


class _Refused(Exception):
    """Why a rod cannot be made; ``path`` is the key, below the rods."""

    def __init__(self, path: Path, reason: str):
        super().__init__(reason)
        self.path = path


@dataclass
class _Rod:
    """The data of a rod, and the lines of its keys, by their path below it."""

    data: Any
    lines: Lines = field(default_factory=dict)

    def get(self, key: str) -> Any:
        return child(self.data, key)

    def without(self, *keys: str) -> _Rod:
        if not isinstance(self.data, dict):
            return self
        data = {key: item for key, item in self.data.items() if key not in keys}
        return _Rod(data, {p: line for p, line in self.lines.items() if p[:1] not in zip(keys)})


def expand(source: Source, scope: Scope) -> list[Problem]:
    """Write out all rods in ``source.data`` and ``source.lines``; return what is wrong.

    ``scope``: the parameters of the case, for counts. Rods that cannot be made are left out.
    """
    rods = source.data.get("rods")
    if not isinstance(rods, dict) or not any(is_copy(rod) for rod in rods.values()):
        return []
    problems, made, keys = [], {}, 0
    factory = _Factory(source, scope)
    for name in rods:
        try:
            for new, rod in factory.make(name).items():
                made[new], keys = rod, keys + len(rod.lines)
            if len(made) > MOST_RODS or keys > MOST_KEYS:
                raise _Refused((name,), f"too much: more than {MOST_RODS} rods or {MOST_KEYS} keys")
        except _Refused as refused:
            problems.append(source.problem((*RODS, *refused.path), str(refused)))
    _put(source, made)
    return list(dict.fromkeys(problems))


def is_copy(rod: Any) -> bool:
    """Whether a rod of the file is written as another, or several times."""
    return child(rod, "like") is not None or child(rod, "repeat") is not None


def is_late(path: Path, data: Any) -> bool:
    """Whether a path is one of a copy, which is there only after ``expand``."""
    rods = child(data, "rods")
    if path[:1] != RODS or len(path) == 1 or child(rods, path[1]) is not None:
        return False
    return is_copy(child(rods, _split(path[1])[0]))


def inherited(data: Any, path: Path) -> Any:
    """Return what a rod has at a path from those it is like, as they are written, or None."""
    rods = child(data, "rods")
    if path[:1] != RODS or len(path) == 1 or not isinstance(rods, dict):
        return None
    name, below = path[1], path[2:]
    for _ in rods:
        name = child(child(rods, name), "like")
        value = child(rods, name) if isinstance(name, str) else None
        for part in below:
            value = child(value, part)
        if value is not None:
            return value
    return None


class _Factory:
    """Makes rods from how they are written; each is put together once."""

    def __init__(self, source: Source, scope: Scope):
        self.source, self.scope = source, scope
        self.place = source.root.child("rods").child("")
        self.written = {name: _Rod(data) for name, data in source.data["rods"].items()}
        for path, line in source.lines.items():
            if path[:1] == RODS and len(path) > 1:
                self.written[path[1]].lines[path[2:]] = line
        self.whole: dict[str, _Rod] = {}

    def make(self, name: str) -> dict[str, _Rod]:
        """Return the rod or rods that a name of the file stands for."""
        rod = self._whole(name)
        like = self.written[name].get("like")
        if rod.get("repeat") is None:
            if like is not None:
                self.source.origins[name] = f"like {clipped(like)}"
            return {name: rod.without("repeat")}
        made = {}
        for number in range(self._count(name, rod)):
            new = f"{name}_{number}"
            if new in self.written:
                raise _Refused((name, "repeat"), f"there is a rod '{clipped(new)}' already")
            made[new] = _numbered(rod, number)
            self.source.origins[new] = f"number {number} of {name}"
        return made

    def _whole(self, name: str) -> _Rod:
        """Return a rod with all that it has from those it is like."""
        rod = None
        for derived in reversed(self._chain(name)):
            if derived not in self.whole:
                own = self.written[derived].without("like")
                self.whole[derived] = self._merged(self._base(derived, rod), own) if rod else own
            rod = self.whole[derived]
        return rod

    def _chain(self, name: str) -> list[str]:
        """Return the rod, the one it is like, and so on, to the first that is known."""
        chain = {}  # for its order
        while name not in chain:
            chain[name] = True
            like = self.written[name].get("like")
            if like is None or name in self.whole:
                return list(chain)
            name = self._template(name, like)
        first, words = circle(list(chain)[list(chain).index(name) :], list(self.written))
        raise _Refused((first, "like"), words)

    def _template(self, name: str, like: Any) -> str:
        """Return the rod of the file that ``like`` names: itself, or the one it is a copy of."""
        where = (name, "like")
        if not isinstance(like, str):
            raise _Refused(where, "must be the name of a rod")
        base, number = _split(like)
        if like in self.written:
            return like
        if number is not None and child(self.written.get(base, _Rod(None)).data, "repeat"):
            return base
        names = list(self.written)
        hint = did_you_mean(like, names) or f": the rods are {one_of(names[:20])}"
        raise _Refused(where, f"no such rod{hint}")

    def _base(self, derived: str, rod: _Rod) -> _Rod:
        """Return what a rod is like, which may be one copy of many."""
        like = self.written[derived].get("like")
        if like is None or like in self.written:
            return rod
        return _numbered(rod, _split(like)[1])

    def _merged(self, base: _Rod, own: _Rod) -> _Rod:
        data = _merge(base.data, own.data, self.place)
        kept = {path: line for path, line in base.lines.items() if path and _has(data, path)}
        return _Rod(data, kept | own.lines)

    def _count(self, name: str, rod: _Rod) -> int:
        """Return how many copies there are."""
        given, where = rod.get("repeat"), (name, "repeat")
        try:
            count = self.scope.count(given) if isinstance(given, str) else given
        except ExpressionError as error:
            raise _Refused(where, str(error)) from None
        if type(count) is not int:
            raise _Refused(where, "must be a whole number")
        if not 1 <= count <= MOST_RODS:
            raise _Refused(where, f"must be between 1 and {MOST_RODS}")
        if count * len(rod.lines) > MOST_KEYS:
            raise _Refused(where, f"too much: more than {MOST_KEYS} keys")
        for place, taken in ((where, rod.get("parameters")), ((), self.scope.values)):
            if isinstance(taken, dict) and NUMBER in taken:
                reason = f"the parameter {NUMBER} is the number of a repeated rod: rename it"
                raise _Refused(place or where, reason)
        return count


def _numbered(rod: _Rod, number: int) -> _Rod:
    """Return one copy of many: it has its number as a parameter."""
    data = copy.deepcopy(rod.without("repeat").data)
    own = data.get("parameters")
    data["parameters"] = {**(own if isinstance(own, dict) else {}), NUMBER: number}
    line = rod.lines.get(("repeat",))
    more = {("parameters",): line, ("parameters", NUMBER): line}
    return _Rod(data, more | rod.without("repeat").lines)


def _split(name: str) -> tuple[str, int | None]:
    """Return ``carpet`` and 3 of ``carpet_3``."""
    base, _, number = name.rpartition("_")
    short = number.isascii() and number.isdecimal() and len(number) < 9
    return (base, int(number)) if short else (name, None)


def _merge(base: Any, own: Any, place: Place | None) -> Any:
    """Return ``own`` with what it leaves open from ``base``: mappings merged, all else replaced.

    Where the ``kind`` is another one, keys that it does not have are left behind.
    """
    if not isinstance(base, dict) or not isinstance(own, dict):
        return own
    kept = dict(base)
    if place is not None and own.get("kind", base.get("kind")) != base.get("kind"):
        keys = place.keys(own)
        kept = {key: item for key, item in base.items() if key in keys}
    for key, item in own.items():
        below = place and place.child(key, own)
        kept[key] = _merge(kept.get(key), item, below)
    return kept


def _has(data: Any, path: Path) -> bool:
    above = data
    for part in path[:-1]:
        above = child(above, part)
    here = isinstance(above, dict) and path[-1] in above
    return here or child(above, path[-1]) is not None


def _put(source: Source, made: dict[str, _Rod]) -> None:
    source.data["rods"] = {name: rod.data for name, rod in made.items()}
    source.lines = {p: line for p, line in source.lines.items() if p[:1] != RODS or len(p) == 1}
    for name, rod in made.items():
        source.lines |= {(*RODS, name, *path): line for path, line in rod.lines.items()}
