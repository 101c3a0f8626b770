"""Points that are near to each other but no neighbours along a rod, for what is asked once.

What is asked thousands of times a second is in :mod:`rodsim.forces.spheres`. Nothing here is
compiled, so the checks of a case need not wait for Numba.
"""

from __future__ import annotations

import numpy as np

from rodsim.nodes import Rods

DIRECTION = np.array([0.4837592014, 0.6180339887, 0.6197138255])  # along nothing in particular
WIDER = 1.0001  # than a limit: its length is not quite 1
MOST = 1 << 20  # candidates looked at together


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
    along = DIRECTION @ position[:, : rods.points]
    order = np.argsort(along, kind="stable")
    along, sorted_points = along[order], position[:, order]
    following = np.searchsorted(along, along + limit * WIDER, "right") - 1 - np.arange(along.size)
    found = [(np.zeros(0, int), np.zeros(0, int), np.zeros(0))]
    for i, j in _runs(following):
        apart = sorted_points[:, i] - sorted_points[:, j]
        distance = np.sqrt((apart * apart).sum(axis=0))
        near = np.flatnonzero(distance <= limit)
        ends = order[i[near]], order[j[near]]
        first, second = np.minimum(*ends), np.maximum(*ends)
        kept = _count(rods, excluded, first, second)
        found.append((first[kept], second[kept], distance[near[kept]]))
    first, second, distance = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return first, second, distance


def _runs(following):
    """Yield i (n,), j (n,): each number with so many that follow it, some ``MOST`` at a time."""
    ends, begin = np.cumsum(following), 0
    while begin < len(following):
        before = ends[begin] - following[begin]
        end = max(begin + 1, int(np.searchsorted(ends, before + MOST, "right")))
        many = following[begin:end]
        i = np.repeat(np.arange(begin, end), many)
        yield i, i + 1 + np.arange(len(i)) - np.repeat(ends[begin:end] - many - before, many)
        begin = end


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
