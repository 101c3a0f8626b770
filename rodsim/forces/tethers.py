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
from rodsim.compiled.parts import FORCE, Part
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

    kernel = "rodsim.forces.tether_force:apply_tethers"
    return [
        Part("tethers", FORCE, kernel, fixed=fixed, external=True, potential=True,
             observe=observe, series=series, labels={"tether_energy": tuple(case.tethers)})
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
    table = fixed.reshape(-1, TETHER)
    places = []
    for end in (table[:, 3 : 3 + END], table[:, 3 + END :]):
        nodes, shares = end[:, :2].astype(int), end[:, 2:4]
        points = end[:, POINT:TURNS].T
        turned = np.einsum("ick,ik->ck", state.director[:, :, nodes[:, 0]], points)
        points = np.where(end[:, TURNS] != 0.0, turned, points)
        places.append((state.position[:, nodes] * shares).sum(axis=2) + points)
    stretched = np.linalg.norm(places[1] - places[0], axis=0) - table[:, 1]
    return np.where(stretched * table[:, 2] < 0.0, 0.0, 0.5 * table[:, 0] * stretched**2)


KIND = Kind(
    build=_build,
    word="tethers",
    where="Case",
    words=Annotated[dict[Name, Tether], AfterValidator(not_empty)],
    about="springs between places on rods and bodies and points in space, by name",
    check=_check,
)
