"""Tethers: springs between points of rods, or from a rod to a point in space.

With d from one end to the other, F = k (|d| - l) d/|d| on the first end and -F on the other, where
k is the stiffness and l the length at rest; E = 1/2 k (|d| - l)^2. ``only: pull`` makes it a rope,
without force where |d| < l, ``only: push`` a strut. At a place between two points both take their
linear share, so a tether between rods has no net force and no net torque. It adds a rate of up to
2 k/(4 pi mu epsilon) to those of the scene.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Discriminator, Field, Tag, create_model

from rodsim.case.fields import (
    Model,
    Name,
    NotNegative,
    Positive,
    Vector,
    not_empty,
    number_tag,
    quantity,
)
from rodsim.compiled.kernels import part
from rodsim.compiled.parts import FORCE, Part, Statics
from rodsim.errors import CaseError
from rodsim.forces.places import AT, S, arc_length, at_field, check_place, rod_named, s_field
from rodsim.forces.places import shares as shares_at
from rodsim.registry import Kind

PULL_OR_PUSH = {None: 0.0, "pull": 1.0, "push": -1.0}
END = 7  # numbers of an end: two nodes, two shares, a point in space
TETHER = 3 + 2 * END


class OnRod(Model):
    """A place on a rod."""

    rod: Name = Field(description="the rod")
    at: AT = at_field()
    s: S = s_field()


End = Annotated[
    Annotated[OnRod, Tag("<mapping>")] | Annotated[Vector, Tag("<list>")],
    Discriminator(number_tag),
]


class _Tether(Model):
    """A spring between two places."""

    stiffness: Positive = quantity("stiffness", "k: force per change of length")
    length: NotNegative = quantity("length", "l: length at rest", default=0.0)
    only: Literal["pull", "push"] | None = Field(
        None, description="pull: a rope, slack where it is shorter; push: a strut"
    )


Tether = create_model(  # `from` is a word of Python's, and cannot be written as a field
    "Tether",
    __base__=_Tether,
    __module__=__name__,
    __doc__=_Tether.__doc__,
    **{
        "from": (End, quantity("length", "one end: a place on a rod, or a point x, y, z")),
        "to": (End, quantity("length", "the other end")),
    },
)


def _ends(tether):
    return {key: getattr(tether, key) for key in ("from", "to")}


def _check(case, rod_names) -> Iterator[tuple]:
    for name, tether in (case.tethers or {}).items():
        path, on_rods = ("tethers", name), 0
        for key, end in _ends(tether).items():
            if isinstance(end, OnRod):
                on_rods += 1
                yield from check_place(end, (*path, key), end.rod, case, rod_names)
        if not on_rods:
            yield path, "holds no rod: give a place on one, such as to: {rod: NAME, at: end}"
        first, second = _ends(tether).values()
        if first == second:
            yield path, "holds a place to itself: from and to are the same"
        if tether.only == "push" and tether.length == 0.0:
            yield (*path, "length"), "is needed where a tether can only push"


def _numbers(end, rods, path, case) -> list[float]:
    """Return nodes, shares and place of an end; node -1 is a point in space."""
    if not isinstance(end, OnRod):
        return [-1.0, -1.0, 0.0, 0.0, *end]
    rod = rod_named(rods, end.rod)
    pairs = [*shares_at(arc_length(end, rod, path, case), rod), (0, 0.0)][:2]
    return [float(k) for k, _ in pairs] + [share for _, share in pairs] + [0.0, 0.0, 0.0]


def _build(case, scene) -> list[Part]:
    if not case.tethers:
        return []
    if scene.planar:
        _check_plane(case, scene)
    fixed = [
        number
        for name, tether in case.tethers.items()
        for number in (
            tether.stiffness,
            tether.length,
            PULL_OR_PUSH[tether.only],
            *(
                n
                for key, end in _ends(tether).items()
                for n in _numbers(end, scene.rods, ("tethers", name, key), case)
            ),
        )
    ]
    fixed = np.array(fixed, dtype=float)
    series = (("tether_energy", (len(case.tethers),), (1, 2, -2)),)

    def observe(state, row, scene):
        return {"tether_energy": tether_energies(fixed, state.position)}

    def stiffness(state, row, scene):
        return tether_stiffness(fixed, state.position)

    kernel = "rodsim.forces.tethers:apply_tethers"
    return [
        Part("tethers", FORCE, kernel, fixed=fixed, external=True, potential=True,
             observe=observe, series=series, statics=Statics(stiffness=stiffness))
    ]  # fmt: skip


def _check_plane(case, scene):
    plane = scene.initial.position[0, 0]
    for name, tether in case.tethers.items():
        for key, end in _ends(tether).items():
            if not isinstance(end, OnRod) and abs(end[0] - plane) > 1e-12 * scene.length_scale:
                reason = f"lies beside the plane of the scene, x = {plane:.6g}"
                raise CaseError([case.source.problem(("tethers", name, key), reason)])


@part
def apply_tethers(row, fixed, rods, state, loads, velocities):
    """Add the force of every tether to the nodes that hold its ends."""
    position = state[0]
    for begin in range(0, fixed.size, TETHER):
        first, second = begin + 3, begin + 3 + END
        d = np.empty(3)
        for c in range(3):
            d[c] = fixed[second + 4 + c] - fixed[first + 4 + c]
            for j in range(2):
                if fixed[first] >= 0.0:
                    d[c] -= fixed[first + 2 + j] * position[c, int(fixed[first + j])]
                if fixed[second] >= 0.0:
                    d[c] += fixed[second + 2 + j] * position[c, int(fixed[second + j])]
        distance = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        stiffness, length, side = fixed[begin], fixed[begin + 1], fixed[begin + 2]
        if (distance - length) * side < 0.0:
            continue
        pull = stiffness
        if length > 0.0:  # ends at one place have no direction to be pushed in
            pull = stiffness * (1.0 - length / distance) if distance > 0.0 else 0.0
        for c in range(3):
            for j in range(2):
                if fixed[first] >= 0.0:
                    loads[c, int(fixed[first + j])] += fixed[first + 2 + j] * pull * d[c]
                if fixed[second] >= 0.0:
                    loads[c, int(fixed[second + j])] -= fixed[second + 2 + j] * pull * d[c]


def tether_energies(fixed: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Return 1/2 k (|d| - l)^2 of each tether, 0 where it is slack; position (3, N)."""
    table, _, _, d = _vectors(fixed, position)
    stretched = np.linalg.norm(d, axis=0) - table[:, 1]
    return np.where(stretched * table[:, 2] < 0.0, 0.0, 0.5 * table[:, 0] * stretched**2)


def tether_stiffness(fixed: np.ndarray, position: np.ndarray):
    """Return the second derivatives of the energies as (i, j, blocks), see ``parts.Statics``.

    With shares w of the nodes in d they are w_i w_j k ((1 - l/|d|) 1 + l d d^T/|d|^3).
    """
    table, nodes, weights, d = _vectors(fixed, position)
    distance = np.linalg.norm(d, axis=0)
    taut = (distance - table[:, 1]) * table[:, 2] >= 0.0
    share = np.divide(table[:, 1], distance, out=np.zeros_like(distance), where=distance > 0.0)
    unit = d / np.where(distance > 0.0, distance, 1.0)
    along = share * unit[:, None] * unit[None] + (1.0 - share) * np.eye(3)[:, :, None]
    blocks = np.einsum("t,ta,tb,cdt->tabcd", table[:, 0] * taut, weights, weights, along)
    first = np.repeat(nodes[:, :, None], 4, axis=2)
    return first.ravel(), first.swapaxes(1, 2).ravel(), blocks.reshape(-1, 3, 3)


def _vectors(fixed, position):
    """Return the table of tethers (t, 17), the nodes and weights (t, 4) of d, and d (3, t)."""
    table = fixed.reshape(-1, TETHER)
    ends = table[:, 3 : 3 + END], table[:, 3 + END :]
    nodes = np.concatenate([end[:, :2] for end in ends], axis=1).astype(int)
    weights = np.concatenate([-ends[0][:, 2:4], ends[1][:, 2:4]], axis=1)
    weights, nodes = np.where(nodes < 0, 0.0, weights), np.maximum(nodes, 0)
    d = (position[:, nodes] * weights).sum(axis=2) + ends[1][:, 4:].T - ends[0][:, 4:].T
    return table, nodes, weights, d


KIND = Kind(
    build=_build,
    word="tethers",
    where="Case",
    words=Annotated[dict[Name, Tether], AfterValidator(not_empty)],
    about="springs between places on rods and points in space, by name",
    check=_check,
)
