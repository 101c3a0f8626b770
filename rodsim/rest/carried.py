"""Free bodies, and the ends of rods that they hold, where states at rest are looked for.

A held end goes where its body goes, X = X_b + R p, and its triad with it where it is clamped. So
its loads are the body's, g and r x g + m with r = X - X_b, and the stiffness of the six degrees of
freedom of a body is that of all that changes as it moves with its ends: central differences of
order 6 of all loads, by steps that are short beside the reach of contact.
"""

from __future__ import annotations

import numpy as np

from rodsim.compiled.parts import PLACE
from rodsim.rest.stiffness import TURNS
from rodsim.scene.evaluation import Evaluation

STEP, ANGLE = 2e-3, 1e-3  # of the spacing, rad


class Carried:
    """What free bodies carry in a scene. ``free`` : the degrees of freedom c N + k that may change.

    bodies : nodes of free bodies.
    """

    def __init__(self, scene, free: np.ndarray):
        n = scene.nodes
        self.scene, self.free = scene, free
        self.ends = [end for part in scene.parts for end in part.statics.carries]
        self.bodies = sorted({int(k) for k in free % n if k >= scene.rods.points})
        self._numbers = [c * n + body for body in self.bodies for c in range(6)]
        self._placing = Evaluation(scene, scene.parts.of(PLACE)) if self.ends else None

    def placed(self, state):
        """Put held ends where their bodies are; return the state."""
        if self._placing is not None:
            none = np.zeros((6, self.scene.nodes))
            self._placing.add(state, none, none, np.zeros_like(state.tracer))
        return state

    def passed_on(self, loads: np.ndarray, state) -> np.ndarray:
        """Add the loads (6, N) of held ends to those of their bodies; return them."""
        for body, node, clamped in self.ends:
            arm = state.position[:, node] - state.position[:, body]
            loads[:3, body] += loads[:3, node]
            loads[3:, body] += np.cross(arm, loads[:3, node])
            if clamped:
                loads[3:, body] += loads[3:, node]
        return loads

    def whole(self, change: np.ndarray, before, after) -> np.ndarray:
        """Return a change (6, N) of the free degrees of freedom with that of held ends."""
        if not self.ends:
            return change
        change = change.copy()
        change[:3] = after.position - before.position
        for body, node, clamped in self.ends:
            if clamped:
                change[3:, node] = change[3:, body]
        return change

    def coupled(self, matrix, state, loads_after):
        """Return the stiffness of the free degrees of freedom from that of all, each on its own.

        loads_after : called with a change (6, N), returns the loads (6, N) after it. The columns of
        bodies are its differences. Their rows are the loads of held ends that other nodes change,
        and of forces that act on bodies themselves, which have energies, the transposed columns.
        """
        from scipy.sparse import coo_array, csr_array, diags_array

        inner = matrix[self.free][:, self.free]
        if not self.bodies:
            return inner
        ways = self._ways(state)
        held = csr_array(ways.T @ matrix)[:, self.free].toarray()  # rows, by way of held ends
        columns = np.array([self._column(number, loads_after) for number in self._numbers])
        rows = held + columns - (matrix @ ways)[self.free].toarray().T
        at, outer = np.searchsorted(self.free, self._numbers), np.ones(len(self.free))
        outer[at] = 0.0
        rows[:, at] = 0.0
        found, shape = diags_array(outer) @ inner @ diags_array(outer), inner.shape
        for values, turned in ((columns, False), (rows, True)):
            j, i = np.nonzero(values)
            places = (at[j], i) if turned else (i, at[j])
            found = found + coo_array((values[j, i], places), shape=shape)
        return found.tocsc()

    def _ways(self, state):
        """Return how held ends go with their bodies: a sparse matrix (6 N, 6 B) of changes."""
        from scipy.sparse import lil_array

        n, found = self.scene.nodes, lil_array((6 * self.scene.nodes, len(self._numbers)))
        for body, node, clamped in self.ends:
            first, arm = 6 * self.bodies.index(body), state.position[:, node]
            arm = arm - state.position[:, body]
            turns = np.cross(np.eye(3), arm)  # theta x arm, of each unit theta in a row
            for c in range(3):
                found[c * n + node, first + c] = 1.0
                for axis in range(3):
                    found[c * n + node, first + 3 + axis] = turns[axis, c]
                if clamped:
                    found[(3 + c) * n + node, first + 3 + c] = 1.0
        return found.tocsc()

    def _column(self, number, loads_after):
        """Return -d(loads)/dz of the free ones, z one degree of freedom of a body."""
        n = self.scene.nodes
        step = STEP * self.scene.rods.spacing.min() if number < 3 * n else ANGLE
        total = np.zeros(len(self.free))
        for multiple, weight in TURNS:
            change = np.zeros((6, n))
            change.flat[number] = multiple * step
            total -= weight / step * loads_after(change).ravel()[self.free]
        return total
