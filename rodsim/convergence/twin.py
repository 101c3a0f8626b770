"""A run again from a start that differs in the last bit, with the same steps.

Left to itself it would soon take others, and ends would be apart by as much as both err.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rodsim.integrators.rkc import RKC


class Retraced(RKC):
    """RKC with the steps of a run before it: ``taken``, the size and the fastest rate of each."""

    def __init__(self, system, taken):
        super().__init__(system, tolerance=1.0)
        self._taken, self._size = iter(taken), 0.0

    def _estimate_rate(self, state, f0):
        pass

    def _accepted(self, state, f0, end):
        size, self.fastest_rate = next(self._taken)
        return size, self.attempt(state, f0, size)


def end_of_twin(machine, taken, end: float):
    """Return the end of a run of ``machine`` from the nudged start."""
    system = machine.system
    state = nudged(system.scene)
    for step in Retraced(system, taken).steps(state, end):
        state = step.end
    return state


def nudged(scene):
    """Return the initial state, every coordinate changed by what rounding leaves uncertain in it.

    That is the last bit of a number as large as the longest rod: of a coordinate that is 0 by
    symmetry, rounding leaves as much.
    """
    initial = scene.initial
    signs = np.random.default_rng(2013).choice([-1.0, 1.0], initial.position.shape)
    if scene.planar:
        signs[0] = 0.0
    return replace(initial, position=initial.position + signs * np.spacing(scene.length_scale))
