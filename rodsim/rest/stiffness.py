"""The stiffness K = -d(loads)/dz of a state: differences along rods, blocks of what couples more.

z are positions and rotation vectors of all nodes, degree of freedom c N + k for component c of
node k. A load depends on its own node and the neighbours along the rod, so nodes three apart are
displaced together: 3 to 5 groups of nodes. Loads of rods are quadratic in X at given triads, where
central differences are exact; in the rotation vectors, steps of 0.02 rad and order 6 leave 1e-14.
"""

from __future__ import annotations

import numpy as np

from rodsim.compiled.parts import PartList
from rodsim.rest.differences import differences
from rodsim.scene.calls import Calls

ONE_SIDE = ((1, 45.0 / 60.0), (2, -9.0 / 60.0), (3, 1.0 / 60.0))  # f' to order 6
TURNS = np.array([(side * m, side * weight) for m, weight in ONE_SIDE for side in (1, -1)])
STENCILS = np.array([(1.0, 0.5), (-1.0, -0.5)]), TURNS
ANGLE, SHARE = 0.02, 0.3  # steps: rad, and of the spacing


class Differences:
    """Differences of the loads of forces that act along rods, at any state of a scene."""

    def __init__(self, scene, parts: PartList):
        self._rods, self._calls = scene.rods, Calls(parts, counted=lambda part: False)
        n, points = scene.nodes, scene.rods.points
        number = np.where(np.arange(n) < points, np.arange(n), -1)  # bodies stay
        self._nearby = np.stack([np.full(n, -1), number, np.full(n, -1)])
        self._groups, self._steps = np.minimum(number, 0), np.full((6, n), ANGLE)
        for rod in scene.rods:
            number = np.arange(rod.count)
            for row, there in zip((0, 2), _neighbours(number, rod.closed), strict=True):
                self._nearby[row, rod.nodes] = np.where(there < 0, -1, there + rod.first)
            odd = rod.count % 3 if rod.closed else 0
            beyond = number - (rod.count - odd)  # of the last ones, which have groups of their own
            self._groups[rod.nodes] = np.where(beyond >= 0, 3 + beyond, number % 3)
            self._steps[:3, rod.nodes] = SHARE * rod.spacing

    def __call__(self, state):
        """Return (i, j, blocks) of K, see ``compiled.parts.Statics``."""
        n, calls = len(self._groups), self._calls
        blocks = np.zeros((3, n, 6, 6))  # of the node before, the node itself, the node after
        now = calls.rows_at(np.array([state.time]))[0]
        room = [tuple(np.empty_like(array) for array in state.geometry) for _ in range(2)]
        differences(
            calls.table, calls.numbers, now, self._rods.tables, state.geometry, self._steps,
            self._nearby, self._groups, int(self._groups.max()) + 1, STENCILS, *room, blocks,
        )  # fmt: skip
        there = self._nearby.ravel() >= 0
        own = np.tile(np.arange(n), 3)
        return self._nearby.ravel()[there], own[there], blocks.reshape(-1, 6, 6)[there]


def assembled(parts, n: int):
    """Return the sparse matrix (6 N, 6 N) of lists (i, j, blocks), added up."""
    from scipy.sparse import coo_array

    rows, columns, values = [], [], []
    for i, j, blocks in parts:
        size = np.arange(blocks.shape[1]) * n
        shape = blocks.shape
        rows.append(np.broadcast_to(i[:, None, None] + size[:, None], shape).ravel())
        columns.append(np.broadcast_to(j[:, None, None] + size, shape).ravel())
        values.append(blocks.ravel())
    places = np.concatenate(rows), np.concatenate(columns)
    return coo_array((np.concatenate(values), places), shape=(6 * n, 6 * n)).tocsc()


def _neighbours(number, closed):
    """Return the numbers before and after each of a rod's nodes, -1 where there is none."""
    count = len(number)
    if closed:
        return (number - 1) % count, (number + 1) % count
    return number - 1, np.where(number + 1 < count, number + 1, -1)
