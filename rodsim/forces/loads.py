"""Loads: weight and other forces per length, forces and torques at points, followers.

A load acts on the rod, which passes it on to the fluid: g_k += f, m_k += n. Per length, point k
takes f(s_k) ds, half of it at the two ends of an open rod, so that the total of a constant f is
f L. At a place between two points both take their linear share. In ``frame: triad`` the components
are those along D^1, D^2, D^3 of the point (a follower): its work is not that of a potential.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Field

from rodsim.case.fields import Model, Name, NumberOrExpression, not_empty
from rodsim.compiled.kernels import part
from rodsim.compiled.parts import FORCE, Part
from rodsim.compiled.row import Entry, Row
from rodsim.errors import CaseError
from rodsim.forces.places import AT, S, arc_length, at_field, check_place, end_weights, s_field
from rodsim.forces.places import shares as shares_at
from rodsim.nodes import Rod
from rodsim.registry import Kind

Triple = tuple[NumberOrExpression, NumberOrExpression, NumberOrExpression]
NOTHING = (0.0, 0.0, 0.0)
LOOKED_AT = np.linspace(0.0, 1.0, 12)  # of the run: when it is checked


class Load(Model):
    """A force and a torque on a rod: per length along all of it, or at a place."""

    along: Literal["all"] | None = Field(None, description="all: per length, along the whole rod")
    at: AT = at_field()
    s: S = s_field()
    force: Triple = Field(
        NOTHING, description="force (mass length time^-2), or force per length; may depend on s, t"
    )
    torque: Triple = Field(
        NOTHING, description="torque (mass length^2 time^-2), or torque per length"
    )
    frame: Literal["space", "triad"] = Field(
        "space", description="axes of force and torque: x, y, z, or D1, D2, D3 of the point"
    )


def _check(case, rod_names) -> Iterator[tuple]:
    for name, rod in (case.rods or {}).items():
        for label, load in (rod.loads or {}).items():
            path = ("rods", name, "loads", label)
            if load.along is None:
                yield from check_place(load, path, name, case, rod_names)
            elif load.at is not None or load.s is not None:
                yield path, "is along the whole rod: leave out at and s"
            if not any(entry != 0.0 for entry in (*load.force, *load.torque)):
                yield path, "has neither a force nor a torque"
            if case.plane is not None:
                yield from _out_of_plane(load, path, case.plane)


def _out_of_plane(load, path, plane) -> Iterator[tuple]:
    """A planar scene has forces in its plane and torques across it; D^1 is across it."""
    for key, zero in (("force", (0,)), ("torque", (1, 2))):
        for i in zero:
            if getattr(load, key)[i] != 0.0:
                yield (*path, key, i), f"must be the number 0 where plane is {plane}"


@dataclass(frozen=True)
class _Applied:
    """A load at some nodes with their weights, s where its expressions are taken."""

    load: Load
    nodes: list
    weights: list
    s: np.ndarray
    group: tuple


def _applied(load: Load, rod: Rod, label: str, case) -> _Applied:
    group = rod.name, label
    if load.along is not None:
        nodes = range(rod.first, rod.first + rod.count)
        return _Applied(load, list(nodes), list(end_weights(rod)), rod.points_at, group)
    s = arc_length(load, rod, ("rods", rod.name, "loads", label), case)
    nodes, weights = zip(*shares_at(s, rod), strict=True)
    return _Applied(load, nodes, weights, np.full(len(nodes), s), group)


def _check_finite(found, case) -> None:
    """Refuse a load that is not finite at the start of the run, at its end, or between."""
    times = case.time.end * LOOKED_AT[:, None]
    for item in found:
        for i, value in enumerate((*item.load.force, *item.load.torque)):
            values = value(item.s, times) if callable(value) else np.zeros(1)
            if not np.isfinite(values).all():
                t, k = np.unravel_index(int(np.isfinite(values).argmin()), values.shape)
                at = f"s = {item.s[k]:.4g}, t = {times[t, 0]:.4g}"
                rod, label = item.group
                path = ("rods", rod, "loads", label, ("force", "torque")[i // 3], i % 3)
                raise CaseError([case.source.problem(path, f"is not finite at {at}")])


def _build(case, scene) -> list[Part]:
    found = [
        _applied(load, rod, label, case)
        for rod in scene.rods
        for label, load in (case.rods[rod.name].loads or {}).items()
    ]
    if not found:
        return []
    _check_finite(found, case)
    count = sum(len(item.nodes) for item in found)
    entries, begin = [], 0
    for item in found:
        for i, value in enumerate((*item.load.force, *item.load.torque)):
            entries.append(Entry(value, item.s, i * count + begin, item.group))
        begin += len(item.nodes)
    followers = [float(f.load.frame == "triad") for f in found for _ in f.nodes]
    fixed = [*(k for f in found for k in f.nodes), *(w for f in found for w in f.weights)]
    return [
        Part(
            "loads",
            FORCE,
            "rodsim.forces.loads:apply_loads",
            Row(6 * count, entries),
            np.array([*fixed, *followers], dtype=float),
            drive="a load",
            external=True,
        )
    ]


@part
def apply_loads(row, fixed, rods, state, loads, velocities):
    """Add force and torque of every load; ``fixed``: nodes, weights, whether in the triad."""
    count = fixed.size // 3
    director = state[1]
    for a in range(count):
        k, weight = int(fixed[a]), fixed[count + a]
        for kind in range(0, 6, 3):
            x = weight * row[kind * count + a]
            y = weight * row[(kind + 1) * count + a]
            z = weight * row[(kind + 2) * count + a]
            for c in range(3):
                if fixed[2 * count + a] != 0.0:
                    value = x * director[0, c, k] + y * director[1, c, k] + z * director[2, c, k]
                else:
                    value = (x, y, z)[c]
                loads[kind + c, k] += value


KIND = Kind(
    build=_build,
    word="loads",
    where="Rod",
    words=Annotated[dict[Name, Load], AfterValidator(not_empty)],
    about="forces and torques on the rod, by name: per length or at a place",
    check=_check,
)
