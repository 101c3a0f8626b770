"""Places on rods, in words and in numbers: an end, or an arc length between two points."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

import numpy as np
from pydantic import Field

from rodsim.case.fields import NotNegative, quantity
from rodsim.case.words import did_you_mean
from rodsim.errors import CaseError
from rodsim.nodes import Rod, Rods

AT = Literal["start", "end"] | None
BEYOND = 1e-9  # of a rod's length: rounding in words such as s: L


def at_field():
    """Return the field of a place that is an end."""
    return Field(None, description="start or end: the first or the last point of an open rod")


def s_field():
    """Return the field of a place that is an arc length."""
    about = "or the arc length of the place; between two points both take their share"
    return quantity("length", about, default=None)


S = NotNegative | None


def arc_length(place, rod: Rod, path, case) -> float:
    """Return the arc length of a place with ``at`` or ``s``; CaseError where the rod has none."""
    for found, reason in _not_there(place, path, rod.name, rod.closed, rod.length):
        raise CaseError([case.source.problem(found, reason)])
    if place.s is not None:
        return min(float(place.s), rod.length)
    return 0.0 if place.at == "start" else rod.length


def shares(s: float, rod: Rod) -> list[tuple[int, float]]:
    """Return the nodes of the whole scene that share what is at arc length s, and their shares.

    The two neighbours share linearly, so force and moment of a point load stay those of the place.
    """
    along = min(s / rod.spacing, rod.segments)
    k = min(int(along), rod.segments - 1)
    part = along - k
    pair = [(k, 1.0 - part), ((k + 1) % rod.count, part)]
    return [(rod.first + node, float(share)) for node, share in pair if share > 0.0]


def check_place(place, path, name, case, rod_names) -> Iterator[tuple]:
    """Yield what is wrong with a place on a rod that a case names; ``rod_names``: of all rods."""
    given = [place.at is not None, place.s is not None]
    if sum(given) != 1:
        yield path, "needs one of at: start, at: end, s: (an arc length)"
        return
    if name not in rod_names:
        known = f": the rods are {', '.join(rod_names)}"
        yield (*path, "rod"), f"no such rod{did_you_mean(name, rod_names) or known}"
    if name not in (case.rods or {}):
        return
    shape = case.rods[name].shape
    length = None if shape.ds is None else shape.segments * shape.ds  # of a file: not known yet
    yield from _not_there(place, path, name, shape.is_closed, length)


def _not_there(place, path, name, closed, length) -> Iterator[tuple]:
    if place.at is not None and closed:
        yield (*path, "at"), f"rod '{name}' is closed and has no {place.at}: give s"
    if place.s is not None and length is not None and place.s > length * (1.0 + BEYOND):
        yield (*path, "s"), f"must be <= {length:.6g}, the length of rod '{name}'"


def rod_named(rods: Rods, name: str) -> Rod:
    """Return a rod by name."""
    return rods[rods.names.index(name)]


def end_weights(rod: Rod) -> np.ndarray:
    """Return ds of each point, half of it at both ends of an open rod: they add up to L."""
    weights = np.full(rod.count, rod.spacing)
    if not rod.closed:
        weights[[0, -1]] *= 0.5
    return weights
