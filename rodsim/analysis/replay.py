"""A stored run evaluated again: the loads and velocities of its frames, and states between them."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from rodsim.elasticity import point_loads
from rodsim.rods.restore import restore_scene, stored_state


class Replay:
    """The states of a stored run, at its frames and between them, and what they do to the fluid."""

    def __init__(self, run):
        """``run``: what :func:`rodsim.open_trajectory` returns; needs the triads in its frames."""
        self.run = run
        self.scene = restore_scene(run)

    @cached_property
    def system(self):
        """The system of the scene; compiled only where rates are asked for."""
        from rodsim.dynamics import RodSystem

        return RodSystem(self.scene)

    def state(self, frame: int):
        """Return the state of a frame."""
        return stored_state(self.run, frame)

    def loads(self, state) -> tuple[np.ndarray, np.ndarray]:
        """Return point forces and torques on the fluid, (N, 3) each, of a state."""
        internal, loads = np.empty((2, 6, self.scene.rods.points))
        omega = self.scene.strain_twist(state.time)
        point_loads(state.position, state.director, omega, self.scene.rods.tables, internal, loads)
        return loads[:3].T, loads[3:].T

    def velocity(self, frame: int) -> np.ndarray:
        """Return the velocity (N, 3) of all points in a frame."""
        fields, _ = self.system.observe(self.state(frame))
        return fields["velocity"].T.copy()

    def between(self, frame: int):
        """Return the motion from a frame to the next one, a Step; ``.at(time)`` gives the state.

        Cubic Hermite of the two states and their velocities, error O(interval^4): positions, and
        rotation vectors that lead from the triads of the first frame to those of the second.
        """
        from rodsim.integrators.step import Step

        first, last = self.state(frame), self.state(frame + 1)
        size = last.time - first.time
        system, zero = self.system, self.system.zeros()
        begin = system.rate(first.time, first, zero, np.empty(system.size))
        after = system.rate(last.time, last, zero, np.empty(system.size))
        guess = system.split(0.5 * size * (begin + after))[1]
        turn = rotation_between(first.director, last.director, guess)
        increment = np.concatenate([(last.position - first.position).ravel(), turn.ravel()])
        end = system.rate(last.time, first, increment, np.empty(system.size))
        return Step(system, frame, first, size, increment, last, (begin, end))


def rotation_between(before, after, guess) -> np.ndarray:
    """Return rotation vectors (3, N) that lead from triads to triads, both (3, 3, N).

    Angles are known up to whole turns: of those, the one nearest to ``guess`` (3, N) is taken.
    """
    axial = 0.5 * np.cross(before, after, axis=1).sum(axis=0)
    sine = np.linalg.norm(axial, axis=0)
    cosine = 0.5 * (np.einsum("ick,ick->k", before, after) - 1.0)
    angle = np.arctan2(sine, cosine)
    axis = axial / np.where(sine > 0.0, sine, 1.0)
    turns = np.round(((axis * guess).sum(axis=0) - angle) / (2.0 * np.pi))
    return axis * (angle + 2.0 * np.pi * turns)
