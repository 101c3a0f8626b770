"""Tethers: springs between points of rods, of bodies and in space.

With d from one end to the other, F = k (|d| - l) d/|d| on the first end and -F on the other, where
k is the stiffness and l the length at rest; E = 1/2 k (|d| - l)^2. ``only: pull`` makes it a rope,
without force where |d| < l, ``only: push`` a strut. At a place between two points both take their
linear share, so a tether between rods has no net force and no net torque. At a place p of a body,
X + R p, the body takes the force F and the torque R p x F. A tether at a rod adds a rate of up to
2 k/(4 pi mu epsilon) to those of the scene.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

import numpy as np
from pydantic import AfterValidator

from rodsim.case.fields import Name, not_empty
from rodsim.case.words import did_you_mean
from rodsim.compiled.parts import FORCE, Part, Statics
from rodsim.errors import CaseError
from rodsim.forces.places import arc_length, check_place, rod_named
from rodsim.forces.places import shares as shares_at
from rodsim.forces.tether_words import OnBody, OnRod, Tether
from rodsim.registry import Kind

PULL_OR_PUSH = {None: 0.0, "pull": 1.0, "push": -1.0}
END = 8  # numbers of an end: two nodes, two shares, a point, whether it turns with the first node
POINT, TURNS = 4, 7
TETHER = 3 + 2 * END


def _ends(tether):
    return {key: getattr(tether, key) for key in ("from", "to")}


def _check(case, rod_names) -> Iterator[tuple]:
    for name, tether in (case.tethers or {}).items():
        path, held = ("tethers", name), 0
        for key, end in _ends(tether).items():
            if isinstance(end, OnRod):
                held += 1
                yield from check_place(end, (*path, key), end.rod, case, rod_names)
            elif isinstance(end, OnBody):
                held += 1
                if end.body not in (names := list(case.bodies or {})):
                    known = f": the bodies are {', '.join(names)}" if names else ": there are none"
                    reason = f"no such body{did_you_mean(end.body, names) or known}"
                    yield (*path, key, "body"), reason
        if not held:
            yield path, "holds no rod: give a place on one, such as to: {rod: NAME, at: end}"
        first, second = _ends(tether).values()
        if first == second:
            yield path, "holds a place to itself: from and to are the same"
        if tether.only == "push" and tether.length == 0.0:
            yield (*path, "length"), "is needed where a tether can only push"


def _numbers(end, scene, path, case) -> list[float]:
    """Return nodes, shares and place of an end; node -1 is a point in space."""
    if isinstance(end, OnBody):
        node = next(body.node for body in scene.bodies if body.name == end.body)
        return [node, node, 1.0, 0.0, *end.at, 1.0]
    if not isinstance(end, OnRod):
        return [-1.0, -1.0, 0.0, 0.0, *end, 0.0]
    rod = rod_named(scene.rods, end.rod)
    pairs = [*shares_at(arc_length(end, rod, path, case), rod), (0, 0.0)][:2]
    return [float(k) for k, _ in pairs] + [share for _, share in pairs] + [0.0] * 4


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
                for n in _numbers(end, scene, ("tethers", name, key), case)
            ),
        )
    ]
    fixed = np.array(fixed, dtype=float)
    series = (("tether_energy", (len(case.tethers),), (1, 2, -2)),)

    def observe(state, row, scene):
        return {"tether_energy": tether_energies(fixed, state)}

    def stiffness(state, row, scene):
        return tether_stiffness(fixed, state)

    kernel = "rodsim.forces.tether_force:apply_tethers"
    return [
        Part("tethers", FORCE, kernel, fixed=fixed, external=True, potential=True,
             observe=observe, series=series, labels={"tether_energy": tuple(case.tethers)},
             statics=Statics(stiffness=stiffness))
    ]  # fmt: skip


def _check_plane(case, scene):
    plane = scene.initial.position[0, 0]
    for name, tether in case.tethers.items():
        for key, end in _ends(tether).items():
            if isinstance(end, tuple) and abs(end[0] - plane) > 1e-12 * scene.length_scale:
                reason = f"lies beside the plane of the scene, x = {plane:.6g}"
                raise CaseError([case.source.problem(("tethers", name, key), reason)])


def tether_energies(fixed: np.ndarray, state) -> np.ndarray:
    """Return 1/2 k (|d| - l)^2 of each tether of a state, 0 where it is slack."""
    table, _, _, d = _vectors(fixed, state)
    stretched = np.linalg.norm(d, axis=0) - table[:, 1]
    return np.where(stretched * table[:, 2] < 0.0, 0.0, 0.5 * table[:, 0] * stretched**2)


def tether_stiffness(fixed: np.ndarray, state):
    """Return the second derivatives of the energies as (i, j, blocks), see ``parts.Statics``.

    With shares w of the nodes in d they are w_i w_j k ((1 - l/|d|) 1 + l d d^T/|d|^3). That is by
    places alone: bodies do not turn.
    """
    table, nodes, weights, d = _vectors(fixed, state)
    distance = np.linalg.norm(d, axis=0)
    taut = (distance - table[:, 1]) * table[:, 2] >= 0.0
    share = np.divide(table[:, 1], distance, out=np.zeros_like(distance), where=distance > 0.0)
    unit = d / np.where(distance > 0.0, distance, 1.0)
    along = share * unit[:, None] * unit[None] + (1.0 - share) * np.eye(3)[:, :, None]
    blocks = np.einsum("t,ta,tb,cdt->tabcd", table[:, 0] * taut, weights, weights, along)
    first = np.repeat(nodes[:, :, None], 4, axis=2)
    return first.ravel(), first.swapaxes(1, 2).ravel(), blocks.reshape(-1, 3, 3)


def _vectors(fixed, state):
    """Return the table of tethers (t, 19), the nodes and weights (t, 4) of d, and d (3, t)."""
    table = fixed.reshape(-1, TETHER)
    ends = table[:, 3 : 3 + END], table[:, 3 + END :]
    nodes = np.concatenate([end[:, :2] for end in ends], axis=1).astype(int)
    weights = np.concatenate([-ends[0][:, 2:4], ends[1][:, 2:4]], axis=1)
    weights, nodes = np.where(nodes < 0, 0.0, weights), np.maximum(nodes, 0)
    first, second = (_points(end, state.director) for end in ends)
    d = (state.position[:, nodes] * weights).sum(axis=2) + second - first
    return table, nodes, weights, d


def _points(end, director):
    """Return the points (3, t) of ends, R p of those that turn with a body."""
    points = end[:, POINT:TURNS].T
    turned = np.einsum("ick,ik->ck", director[:, :, end[:, 0].astype(int)], points)
    return np.where(end[:, TURNS] != 0.0, turned, points)


KIND = Kind(
    build=_build,
    word="tethers",
    where="Case",
    words=Annotated[dict[Name, Tether], AfterValidator(not_empty)],
    about="springs between places on rods and bodies and points in space, by name",
    check=_check,
)
