"""Points that are near to each other but no neighbours along a rod, for what is asked once.

What is asked thousands of times a second is in :mod:`rodsim.forces.spheres`. Nothing here is
compiled, so the checks of a case need not wait for Numba.
"""

from __future__ import annotations

import numpy as np

from rodsim.nodes import Rods

DIRECTION = np.array([0.4837592014, 0.6180339887, 0.6197138255])  # along nothing in particular


def segments_within(reach: float, rods: Rods) -> np.ndarray:
    """Return (R,) how many segments of each rod an arc length spans; no more than its points."""
    return np.minimum(np.floor(reach / rods.spacing), rods.count).astype(np.int64)


def pairs_within(position: np.ndarray, rods: Rods, excluded: np.ndarray, limit: float):
    """Return first (n,), second (n,), distance (n,) of points that count and are that near.

    position (3, N), points of rods first. Points count if they are of different rods, or more than
    ``excluded[r]`` segments apart along rod r, the shorter way round a closed one; first < second.
    Points are sorted along a direction that is parallel to nothing, so that only those next to each
    other there have to be looked at.
    """
    position = position[:, : rods.points]
    along = DIRECTION @ position
    order = np.argsort(along, kind="stable")
    found = [(np.zeros(0, int), np.zeros(0, int), np.zeros(0))]
    for step in range(1, len(order)):
        near = along[order[step:]] - along[order[:-step]] <= limit
        if not near.any():
            break
        first, second = np.sort([order[:-step][near], order[step:][near]], axis=0)
        distance = np.linalg.norm(position[:, first] - position[:, second], axis=0)
        kept = (distance <= limit) & _count(rods, excluded, first, second)
        found.append((first[kept], second[kept], distance[kept]))
    first, second, distance = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return first, second, distance


def repulsion_stiffness(position, rods: Rods, fixed: np.ndarray):
    """Return (i, j, blocks (n, 3, 3)) of -dg_i/dX_j of contact, see ``compiled.parts.Statics``.

    fixed : that of :mod:`rodsim.forces.repulsion`. Of a pair, with q = 1 - r^2/d^2 and
    k = 6 A ds_i ds_j/d^2, B = 4 k q/d^2 r r^T - k q^2 on (i, i) and (j, j), -B on (i, j), (j, i).
    """
    n, d = len(rods), fixed[0]
    strength, excluded, ds = fixed[1 : 1 + n], fixed[1 + n : 1 + 2 * n], fixed[1 + 2 * n :]
    i, j, distance = pairs_within(position, rods, excluded.astype(np.int64), d)
    r, s = (np.searchsorted(rods.first, points, "right") - 1 for points in (i, j))
    k = 6.0 * np.minimum(strength[r], strength[s]) * ds[i] * ds[j] / d**2
    q, apart = 1.0 - (distance / d) ** 2, (position[:, i] - position[:, j]).T
    B = (4.0 * k * q / d**2)[:, None, None] * apart[:, :, None] * apart[:, None, :]
    B -= (k * q * q)[:, None, None] * np.eye(3)
    return (
        np.concatenate([i, j, i, j]),
        np.concatenate([i, j, j, i]),
        np.concatenate([B, B, -B, -B]),
    )


def _count(rods, excluded, first, second):
    """Tell which pairs count; ``first`` < ``second``."""
    r, other = (np.searchsorted(rods.first, points, "right") - 1 for points in (first, second))
    apart = second - first
    apart = np.where(rods.closed[r], np.minimum(apart, rods.count[r] - apart), apart)
    return (r != other) | (apart > excluded[r])
