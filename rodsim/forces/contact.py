"""Contact: rods push each other, themselves, bodies and a wall apart before they pass through.

Its words in a case file and its numbers; the formulas are in :mod:`rodsim.forces.repulsion`. They
touch at the distance d of their centrelines. Points of one rod ignore each other within an arc
length, by default pi d/2: a rod bent no tighter than its own thickness does not touch itself there.
No friction, no lubrication, no state. Bodies, where a scene has any, are more parts beside the
pairs and the wall: surfaces that points are held d/2 away from (:mod:`rodsim.forces.bodies`).
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from pydantic import Discriminator, Field, Tag

from rodsim.case.fields import Model, Positive, number_tag, quantity
from rodsim.compiled.parts import FORCE, Apart, Part, Statics
from rodsim.errors import CaseError
from rodsim.forces.bodies import leaky, surfaces_of
from rodsim.forces.near import repulsion_stiffness, segments_within
from rodsim.forces.overlap import at_start, guard
from rodsim.forces.places import end_weights
from rodsim.registry import Kind

DIAMETERS = {"algebraic7": 1.213, "algebraic9": 0.7358}  # hydrodynamic, of the blobs, in epsilons
FEWEST, FEW = 2.0, 2.5  # spacings in a diameter: refused below, warned of below
SHARE_AT_REST = 0.1  # of a diameter: how far a point may move in a step towards rest
EXCLUSION = "contact", "exclusion"
PAIRS, WALL = "rodsim.forces.repulsion:push_apart", "rodsim.forces.repulsion:push_off_wall"


class Epsilons(Model):
    """A length in units of epsilon."""

    epsilons: Positive = Field(description="length / epsilon")


class Contact(Model):
    """Rods push each other, themselves, bodies and the wall apart; {} takes every default."""

    diameter: (
        Annotated[
            Annotated[Positive, Tag("<number>")] | Annotated[Epsilons, Tag("<mapping>")],
            Discriminator(number_tag),
        ]
        | None
    ) = quantity(
        "length",
        "distance of centrelines at which rods touch: a length, or {epsilons: n}; default 1.213 "
        "epsilon (algebraic7), 0.7358 epsilon (algebraic9), as thick as the blob moves",
        default=None,
    )
    strength: Positive = Field(
        20.0, description="C: stiffness, in units of the largest bending modulus over diameter^3"
    )
    exclusion: Positive | None = quantity(
        "length",
        "arc length along a rod within which points ignore each other; default pi/2 diameters",
        default=None,
    )
    pairs: Literal["all", "between"] = Field(
        "all", description="all, or between: different rods only, no rod and itself"
    )


def contact_diameter(contact: Contact, blob: str, epsilon: float) -> float:
    """Return the distance of centrelines at which rods touch."""
    given = contact.diameter
    if given is None:
        return DIAMETERS[blob] * epsilon
    return given.epsilons * epsilon if isinstance(given, Epsilons) else given


def _apart(case, scene) -> Apart:
    contact, rods = case.contact, scene.rods
    diameter = contact_diameter(contact, scene.blob, scene.epsilon)
    reach = contact.exclusion or 0.5 * math.pi * diameter
    if reach < diameter:
        reason = f"must be at least the diameter, {diameter:.6g}: neighbours on a straight rod "
        raise CaseError([case.source.problem(EXCLUSION, reason + "would push each other")])
    alone = len(rods) == 1 and scene.wall is None and not scene.bodies
    if contact.pairs == "between" and alone:
        reason = "there is one rod only, so nothing would touch: leave it out"
        raise CaseError([case.source.problem(("contact", "pairs"), reason)])
    return Apart(diameter, segments_within(reach, rods), contact.pairs == "all")


def _strengths(case, scene, diameter) -> np.ndarray:
    """Return C a/d^3 of each rod, a its largest bending modulus."""
    rods = scene.rods
    bending = rods.moduli[:2] if scene.along is None else scene.along[:2]
    largest = [
        bending[:, r if scene.along is None else rod.nodes].max() for r, rod in enumerate(rods)
    ]
    return case.contact.strength / diameter**3 * np.array(largest)


def _build(case, scene) -> list[Part]:
    if case.contact is None:
        return []
    apart, rods = _apart(case, scene), scene.rods
    diameter = apart.diameter
    refused, coarse = _spacings(case, rods, diameter)
    if refused:
        raise CaseError(refused)
    strengths, ds = _strengths(case, scene, diameter), np.concatenate([*map(end_weights, rods)])
    ignored = apart.excluded if apart.itself else rods.count
    fixed = np.concatenate([[diameter], strengths, ignored, ds])
    weights = np.repeat(strengths, rods.count) * ds
    on_wall = None if scene.wall is None else np.array([scene.wall, diameter, *weights])
    surfaces, shown = None, {}
    if scene.bodies:
        surfaces = surfaces_of(case, scene, diameter, weights, strengths.max(), apart.excluded)
        shown = {"labels": {"contact_energy": surfaces.labels}}
        coarse = [*coarse, *leaky(case, scene)]
        apart = replace(apart, beside=lambda state: 2.0 * surfaces.closest(state)[0])
    close = at_start(case, scene, apart, surfaces)
    rows = len(rods) + len(scene.bodies)
    pairs = Part(
        "contact", FORCE, PAIRS, fixed=fixed, observe=_observer(fixed, on_wall, surfaces),
        series=(("contact_energy", (rows,), (1, 2, -2)),), apart=apart,
        guard=guard(case, scene, fixed, surfaces), **shown,
        warnings=(*coarse, *_too_short(case, rods, apart), *close),
        statics=Statics(stiffness=_stiffness(fixed), move=SHARE_AT_REST * diameter),
    )  # fmt: skip
    parts = [pairs]
    if on_wall is not None:
        outside = {"external": True, "potential": True}
        parts.append(Part("contact_wall", FORCE, WALL, fixed=on_wall, **outside))
    return [*parts, *(surfaces.parts if surfaces else ())]


def _stiffness(fixed):
    def stiffness(state, row, scene):
        """Return the second derivatives of the energy of all pairs."""
        return repulsion_stiffness(state.position, scene.rods, fixed)

    return stiffness


def _spacings(case, rods, diameter):
    """Return (errors, warnings) where the points of a rod are too far apart to hold others off."""
    errors, warnings = [], []
    for rod in rods:
        share = diameter / rod.spacing
        if share < FEW:
            reason = (
                f"{diameter:.4g} is {share:.3g} spacings of rod '{rod.name}': points would slip "
                f"between points; use at least {FEWEST:g} (better 4), or more points"
            )
            found = case.source.problem(("contact", "diameter"), reason)
            (errors if share < FEWEST else warnings).append(found)
    return errors[:1], warnings[:1]


def _too_short(case, rods, apart):
    """Yield that closed rods are too short to touch themselves."""
    names = [
        rod.name
        for rod, excluded in zip(rods, apart.excluded, strict=True)
        if rod.closed and rod.count // 2 <= excluded
    ]
    if apart.itself and names:
        who = f"rod '{names[0]}' is" if len(names) == 1 else f"{len(names)} closed rods are"
        reason = f"{who} shorter than two exclusions: no contact with itself"
        yield case.source.problem(("contact",), reason)


def _observer(fixed, on_wall, surfaces):
    def observe(state, row, scene):
        """Return the energy of each rod's contacts, and each body's, half of a pair to either."""
        from rodsim.forces.repulsion import pair_energies, wall_energies

        energies, rods = np.zeros(len(scene.rods)), scene.rods.tables
        pair_energies(fixed, rods, state.position, energies)
        if on_wall is not None:
            energies += wall_energies(on_wall, rods, state.position)
        if surfaces is not None:
            bodies = np.zeros(len(scene.bodies))
            energies = np.concatenate([energies, bodies]) + surfaces.meet(state)[0]
        return {"contact_energy": energies}

    return observe


KIND = Kind(
    build=_build,
    word="contact",
    where="Case",
    words=Contact,
    about="rods push each other, themselves, bodies and the wall apart; left out: no contact",
)
