"""What bodies and held ends ask of a case beyond the type of each of their words."""

from __future__ import annotations

from collections.abc import Iterator

from rodsim.blocks.ends import ENDS
from rodsim.case.words import did_you_mean

HELD_IN = "space"


def check(case, rod_names) -> Iterator[tuple]:
    """Yield (path, reason) of what is wrong across the sections of a case, see :class:`Kind`."""
    bodies = case.bodies or {}
    for name in bodies:
        if name == HELD_IN:
            yield ("bodies", name), "is the word for what is no body: choose another name"
        if case.plane is not None:
            yield ("bodies", name), "a planar scene has no bodies: drop plane"
    for name, rod in (case.rods or {}).items():
        for which in ENDS:
            if (end := getattr(rod, which)) is not None:
                for path, reason in _end_problems(case, rod, end, bodies):
                    yield ("rods", name, which, *path), reason


def _end_problems(case, rod, end, bodies):
    if rod.shape.is_closed:
        yield (), "a closed rod has no ends"
    if end.to != HELD_IN and end.to not in bodies:
        known = f": the bodies are {', '.join(bodies)}" if bodies else ": there are no bodies"
        yield ("to",), f"no such body{did_you_mean(end.to, bodies) or known}"
    if case.plane is not None:
        yield from _out_of_plane(case, end)


def _out_of_plane(case, end):
    if end.move is not None:
        for key, zero in (("displace", (0,)), ("turn", (1, 2))):
            for i in zero:
                if getattr(end.move, key)[i] != 0.0:
                    reason = f"must be the number 0 where plane is {case.plane}"
                    yield ("move", key, i), reason
    if end.motor is not None:
        yield ("motor",), f"turns rods out of the plane: drop plane: {case.plane}"
