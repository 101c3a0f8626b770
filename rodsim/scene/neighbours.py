"""Which points of a scene are no neighbours: how thick its rods are, and who counts as too near.

Two points count if they are of different rods, or of one rod and further apart along it than
pi/2 diameters: a circle of that diameter has them opposite each other, so a rod bent no tighter
than its own thickness does not touch itself with points that are nearer than that.
"""

from __future__ import annotations

import math

import numpy as np

# A line of blobs drags the fluid along as a cylinder of radius e^(-1/2) epsilon does (algebraic7;
# e^(-1) epsilon for algebraic9), along the axis and across it: slender-body theory.
DIAMETERS = {"algebraic7": 2.0 * math.exp(-0.5), "algebraic9": 2.0 * math.exp(-1.0)}  # / epsilon
COINCIDENT = 1e-6  # spacings
DIRECTION = np.array([0.4837592014, 0.6180339887, 0.6197138255])  # along nothing in particular


def hydrodynamic_diameter(blob: str, epsilon: float) -> float:
    """Return how thick the rods are to the fluid: 1.213 epsilon or, for algebraic9, 0.736."""
    return DIAMETERS[blob] * epsilon


def excluded(scene) -> np.ndarray:
    """Return (R,) how many segments apart points of each rod are still neighbours.

    floor(pi d / (2 ds)), d the hydrodynamic diameter; no more than the rod has points.
    """
    rods = scene.rods
    reach = 0.5 * np.pi * hydrodynamic_diameter(scene.blob, scene.epsilon)
    segments = np.floor(reach / rods.spacing)
    return np.minimum(segments, rods.count).astype(np.int64)


def any_pair_counts(scene) -> bool:
    """Tell whether a scene has any two points that are no neighbours, or a wall."""
    rods = scene.rods
    farthest = np.where(rods.closed, rods.count // 2, rods.count - 1)
    return scene.wall is not None or len(rods.names) > 1 or bool((farthest > excluded(scene)).any())


def coincident(scene) -> tuple[int, int] | None:
    """Return two points of the initial state that count and lie on each other, or None.

    That is within 1e-6 of the smallest spacing. Points are sorted along a direction that is
    parallel to nothing, so that only those next to each other there have to be looked at.
    """
    position = scene.initial.position[:, : scene.rods.points]
    limit = COINCIDENT * scene.rods.spacing.min()
    along = DIRECTION @ position
    order = np.argsort(along, kind="stable")
    for step in range(1, len(order)):
        near = along[order[step:]] - along[order[:-step]] <= limit
        if not near.any():
            return None
        first, second = np.sort([order[:-step][near], order[step:][near]], axis=0)
        distance = np.linalg.norm(position[:, first] - position[:, second], axis=0)
        found = (distance <= limit) & _count(scene, first, second)
        if found.any():
            which = np.flatnonzero(found)[np.argmin(first[found])]
            return int(first[which]), int(second[which])
    return None


def _count(scene, first, second):
    """Tell which pairs count; ``first`` < ``second``."""
    rods = scene.rods
    r, other = (np.searchsorted(rods.first, points, "right") - 1 for points in (first, second))
    apart = second - first
    apart = np.where(rods.closed[r], np.minimum(apart, rods.count[r] - apart), apart)
    return (r != other) | (apart > excluded(scene)[r])
