"""Hooks as forces with an energy, for states at rest: :mod:`rodsim.blocks.joints` has the formula.

A run has their torques where blocks are solved. Here the end takes the torque of its spring, and
the body that holds it the opposite one.
"""

import numpy as np

from rodsim.blocks import fields as f
from rodsim.blocks.frames import block_of, left_of_block, left_of_member, member_of, set_frames
from rodsim.blocks.joints import set_spring
from rodsim.compiled.flags import STATE, VEC, kernel, unsigned
from rodsim.compiled.kernels import part


@unsigned
def _set_springs(row, fixed, state):
    set_frames(row, fixed, state[0], state[1])
    for q in range(int(fixed[f.MEMBERS])):
        member = member_of(fixed, q)
        holder = left_of_block(fixed, int(member[f.M_BLOCK]))
        set_spring(member, left_of_member(fixed, q), holder, state[1])


@part
def apply_springs(row, fixed, rods, state, loads, velocities):
    """Add the torques of all hooks."""
    _set_springs(row, fixed, state)
    for q in range(int(fixed[f.MEMBERS])):
        member, left = member_of(fixed, q), left_of_member(fixed, q)
        node = int(member[f.M_NODE])
        holder = int(block_of(fixed, int(member[f.M_BLOCK]))[f.NODE])
        for c in range(3):
            loads[3 + c, node] += left[f.SPRING + c]
            if holder >= 0:
                loads[3 + c, holder] -= left[f.SPRING + c]


@kernel(f"void({VEC}, {VEC}, {STATE}, {VEC})")
def spring_energies(row, fixed, state, out):
    """Write the energy of each member's spring, 0 without one."""
    _set_springs(row, fixed, state)
    for q in range(np.uint64(out.size)):
        out[q] = left_of_member(fixed, q)[f.ENERGY]
