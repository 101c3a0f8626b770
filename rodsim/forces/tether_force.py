"""The force of tethers: see :mod:`rodsim.forces.tethers`, which has its formula and numbers."""

import math

import numpy as np

from rodsim.compiled.flags import unsigned
from rodsim.compiled.kernels import part
from rodsim.forces.tethers import END, POINT, TETHER, TURNS


@unsigned
def _set_arm(fixed, end, director, arm):
    """Write the point of an end, or R p where it turns with a body."""
    for c in range(3):
        arm[c] = fixed[end + POINT + c]
    if fixed[end + TURNS] != 0.0:
        for c in range(3):
            arm[c] = 0.0
            for i in range(3):
                arm[c] += director[i, c, int(fixed[end])] * fixed[end + POINT + i]


@unsigned
def _add_torque(fixed, end, arm, pull, d, loads):
    """Add R p x F, F = pull d, to a body."""
    if fixed[end + TURNS] != 0.0:
        node = int(fixed[end])
        for c in range(3):
            i, j = (c + 1) % 3, (c + 2) % 3
            loads[3 + c, node] += pull * (arm[i] * d[j] - arm[j] * d[i])


@part
def apply_tethers(row, fixed, rods, state, loads, velocities):
    """Add the force of every tether to the nodes that hold its ends."""
    position, d, here, there = state[0], np.empty(3), np.empty(3), np.empty(3)
    for begin in range(0, fixed.size, TETHER):
        first, second = begin + 3, begin + 3 + END
        _set_arm(fixed, first, state[1], here)
        _set_arm(fixed, second, state[1], there)
        for c in range(3):
            d[c] = there[c] - here[c]
            for j in range(2):
                if fixed[first] >= 0.0:
                    d[c] -= fixed[first + 2 + j] * position[c, int(fixed[first + j])]
                if fixed[second] >= 0.0:
                    d[c] += fixed[second + 2 + j] * position[c, int(fixed[second + j])]
        distance = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        stiffness, length, side = fixed[begin], fixed[begin + 1], fixed[begin + 2]
        if (distance - length) * side < 0.0:
            continue
        pull = stiffness
        if length > 0.0:  # ends at one place have no direction to be pushed in
            pull = stiffness * (1.0 - length / distance) if distance > 0.0 else 0.0
        for c in range(3):
            for j in range(2):
                if fixed[first] >= 0.0:
                    loads[c, int(fixed[first + j])] += fixed[first + 2 + j] * pull * d[c]
                if fixed[second] >= 0.0:
                    loads[c, int(fixed[second + j])] -= fixed[second + 2 + j] * pull * d[c]
        _add_torque(fixed, first, here, pull, d, loads)
        _add_torque(fixed, second, there, -pull, d, loads)
