"""Surfaces of bodies as an evaluation has left them: where their points are, what they exert."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rodsim.blocks import fields as f


class Skin(NamedTuple):
    """points (3, n), loads (6, n) on the fluid, torques 0, size of the blobs of one surface."""

    points: np.ndarray
    loads: np.ndarray
    epsilon: float


def skins(fixed: np.ndarray) -> list[Skin]:
    """Return the surfaces in the numbers of the blocks of a scene, as views into these."""
    records = fixed[f.HEAD : f.HEAD + f.BLOCK * int(fixed[f.BLOCKS])].reshape(-1, f.BLOCK)
    found = []
    for record in records:
        n, begin = int(record[f.POINTS]), int(record[f.SKIN])
        points = fixed[begin : begin + 3 * n].reshape(3, n)
        loads = fixed[begin + 3 * n : begin + 9 * n].reshape(6, n)
        if n:
            found.append(Skin(points, loads, float(record[f.BLOB])))
    return found


def between(left: np.ndarray, other: np.ndarray, share: float) -> np.ndarray:
    """Return the numbers of the blocks with surfaces a share of the way from one to the other."""
    mixed = left.copy()
    for mine, a, b in zip(skins(mixed), skins(left), skins(other), strict=True):
        mine.points[:] = (1.0 - share) * a.points + share * b.points
        mine.loads[:] = (1.0 - share) * a.loads + share * b.loads
    return mixed


def with_loads(left: np.ndarray, *terms: tuple[float, np.ndarray]) -> np.ndarray:
    """Return the numbers of the blocks with other loads on surfaces: sum of factors times those of
    other numbers.
    """
    mixed = left.copy()
    for k, mine in enumerate(skins(mixed)):
        mine.loads[:] = sum(factor * skins(numbers)[k].loads for factor, numbers in terms)
    return mixed


def surface_pressure(scene, points: np.ndarray, left: np.ndarray) -> np.ndarray:
    """Return the pressure (T,) of all surfaces at points (3, T): eq. (62) of their own blobs."""
    from rodsim.flows.blobs import BLOBS
    from rodsim.flows.by_threads import pressure_kernel

    kernel = pressure_kernel(BLOBS[scene.blob], scene.wall is not None)
    total = np.zeros(points.shape[1])
    for skin in skins(left):
        share = np.zeros_like(total)
        kernel(points, skin.points, skin.loads, skin.epsilon, scene.wall or 0.0, share)
        total += share
    return total
