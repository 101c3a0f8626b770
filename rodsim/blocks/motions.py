"""What motions of blocks make of their points: K y."""

import numpy as np

from rodsim.blocks import fields as f
from rodsim.blocks.frames import block_of, cross, member_of
from rodsim.compiled.flags import unsigned


@unsigned
def subtract_motions(fixed, b, y, x):
    """x -= K y of block b, in its frame; x : at its points, y : its free motions.

    The rates of motors whose torque falls with them are left out: of these alone P K is not 0.
    """
    block = block_of(fixed, b)
    n, begin, spin, u = int(block[f.POINTS]), int(block[f.SURFACE]), np.zeros(3), np.empty(3)
    if block[f.FREE] != 0.0:
        own = fixed[begin : begin + 3 * n].reshape(3, n)
        for c in range(3):
            spin[c] = y[3 + c]
        for i in range(n):
            cross(spin, own[:, i], u)
            for c in range(3):
                x[3 * i + c] -= y[c] + u[c]
    for q in range(int(block[f.COUNT])):
        member, at = member_of(fixed, int(block[f.FIRST]) + q), 3 * n + 6 * q
        if block[f.FREE] != 0.0:
            cross(spin, member[f.ARM : f.ARM + 3], u)
            for c in range(3):
                x[at + c] -= y[c] + u[c]
                x[at + 3 + c] -= spin[c]
        free = int(member[f.SPINS]) - (1 if member[f.LINE] > 0.0 else 0)
        for j in range(free):
            for c in range(3):
                way = member[f.DIRECTIONS + 3 * j + c]
                x[at + 3 + c] -= way * y[int(member[f.SPIN]) + j]
