"""Which points of a scene are no neighbours: how thick its rods are, and who counts as too near.

Two points count if they are of different rods, or of one rod and further apart along it than
pi/2 diameters: a circle of that diameter has them opposite each other, so a rod bent no tighter
than its own thickness does not touch itself with points that are nearer than that. Where rods are
kept apart, by contact, that says how thick they are and who is a neighbour.
"""

from __future__ import annotations

import math

import numpy as np

from rodsim.forces.near import pairs_within, segments_within

# A line of blobs drags the fluid along as a cylinder of radius e^(-1/2) epsilon does (algebraic7;
# e^(-1) epsilon for algebraic9), along the axis and across it: slender-body theory.
DIAMETERS = {"algebraic7": 2.0 * math.exp(-0.5), "algebraic9": 2.0 * math.exp(-1.0)}  # / epsilon
COINCIDENT = 1e-6  # spacings


def hydrodynamic_diameter(blob: str, epsilon: float) -> float:
    """Return how thick the rods are to the fluid: 1.213 epsilon or, for algebraic9, 0.736."""
    return DIAMETERS[blob] * epsilon


def diameter(scene) -> float:
    """Return how thick the rods of a scene are: to each other, or else to the fluid."""
    apart = scene.parts.apart
    return apart.diameter if apart else hydrodynamic_diameter(scene.blob, scene.epsilon)


def excluded(scene) -> np.ndarray:
    """Return (R,) how many segments apart points of each rod are still neighbours.

    floor(pi d / (2 ds)), d the hydrodynamic diameter, or as contact has it; no more than the rod
    has points.
    """
    if scene.parts.apart:
        return scene.parts.apart.excluded
    reach = 0.5 * np.pi * hydrodynamic_diameter(scene.blob, scene.epsilon)
    return segments_within(reach, scene.rods)


def any_pair_counts(scene) -> bool:
    """Tell whether a scene has any two points that are no neighbours, or what counts as such."""
    rods, apart = scene.rods, scene.parts.apart
    if apart is not None and apart.beside is not None:
        return True
    farthest = np.where(rods.closed, rods.count // 2, rods.count - 1)
    return scene.wall is not None or len(rods.names) > 1 or bool((farthest > excluded(scene)).any())


def coincident(scene) -> tuple[int, int] | None:
    """Return the first two points of the initial state that count and lie on each other, or None.

    That is within 1e-6 of the smallest spacing.
    """
    limit = COINCIDENT * scene.rods.spacing.min()
    found = pairs_within(scene.initial.position, scene.rods, excluded(scene), limit)
    first, second, _ = found
    if not len(first):
        return None
    which = int(np.argmin(first))
    return int(first[which]), int(second[which])
