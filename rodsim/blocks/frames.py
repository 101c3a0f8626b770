"""Where blocks are: their frames, and the members that follow them."""

import math

import numpy as np

from rodsim.blocks import fields as f
from rodsim.compiled.flags import unsigned
from rodsim.compiled.kernels import part


@unsigned
def exponential(theta, out):
    """Write the rotation matrix of a rotation vector, eq. (36), row by row into ``out`` (9,)."""
    angle2 = theta[0] ** 2 + theta[1] ** 2 + theta[2] ** 2
    a, b = 1.0 - angle2 / 6.0, 0.5 - angle2 / 24.0
    if angle2 > 1e-8:
        angle = math.sqrt(angle2)
        half = math.sin(0.5 * angle) / angle
        a, b = math.sin(angle) / angle, 2.0 * half * half
    x, y, z = theta[0], theta[1], theta[2]
    out[0], out[1], out[2] = 1.0 - b * (y * y + z * z), b * x * y - a * z, b * x * z + a * y
    out[3], out[4], out[5] = b * x * y + a * z, 1.0 - b * (x * x + z * z), b * y * z - a * x
    out[6], out[7], out[8] = b * x * z - a * y, b * y * z + a * x, 1.0 - b * (x * x + y * y)


@unsigned
def spin_of(theta, rate, out):
    """Write the angular velocity of exp(theta x) where d theta/dt is ``rate``, all (3,)."""
    angle2 = theta[0] ** 2 + theta[1] ** 2 + theta[2] ** 2
    b, c = 0.5 - angle2 / 24.0, 1.0 / 6.0 - angle2 / 120.0
    if angle2 > 1e-6:
        angle = math.sqrt(angle2)
        half = math.sin(0.5 * angle) / angle
        b, c = 2.0 * half * half, (1.0 - math.sin(angle) / angle) / angle2
    once = np.empty(3)
    cross(theta, rate, once)
    twice = np.empty(3)
    cross(theta, once, twice)
    for i in range(3):
        out[i] = rate[i] + b * once[i] + c * twice[i]


@unsigned
def cross(a, b, out):
    """out = a x b, of three numbers each."""
    x, y, z = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    out[0], out[1], out[2] = x, y, z


@unsigned
def turned(R, p, out):
    """out = R p; R (9,) row by row."""
    x, y, z = p[0], p[1], p[2]
    for i in range(3):
        out[i] = R[3 * i] * x + R[3 * i + 1] * y + R[3 * i + 2] * z


@unsigned
def turned_back(R, p, out):
    """out = R^T p."""
    x, y, z = p[0], p[1], p[2]
    for i in range(3):
        out[i] = R[i] * x + R[3 + i] * y + R[6 + i] * z


@unsigned
def block_of(fixed, b):
    """Return the record of block b."""
    begin = f.HEAD + b * f.BLOCK
    return fixed[begin : begin + f.BLOCK]


@unsigned
def member_of(fixed, q):
    """Return the record of member q."""
    begin = f.HEAD + int(fixed[f.BLOCKS]) * f.BLOCK + q * f.MEMBER
    return fixed[begin : begin + f.MEMBER]


@unsigned
def left_of_block(fixed, b):
    """Return what is left of block b."""
    begin = int(fixed[f.BLOCK_LEFT]) + b * f.BLOCK_ROOM
    return fixed[begin : begin + f.BLOCK_ROOM]


@unsigned
def left_of_member(fixed, q):
    """Return what is left of member q."""
    begin = int(fixed[f.MEMBER_LEFT]) + q * f.LEFT
    return fixed[begin : begin + f.LEFT]


@unsigned
def set_frames(row, fixed, position, director):
    """Leave the frame of every block and its given motion.

    A body is where its node is; what holds an end in space is at its origin plus a displacement,
    turned by a rotation vector.
    """
    for b in range(int(fixed[f.BLOCKS])):
        block, left = block_of(fixed, b), left_of_block(fixed, b)
        node, motion = int(block[f.NODE]), int(block[f.MOTION])
        given = left[f.GIVEN : f.GIVEN + 6]
        given[:] = 0.0
        if motion >= 0:
            theta = row[motion + 6 : motion + 9]
            for c in range(3):
                given[c] = row[motion + 3 + c]
            spin_of(theta, row[motion + 9 : motion + 12], given[3:])
        if node >= 0:
            for i in range(3):
                left[f.PLACE + i] = position[i, node]
                for j in range(3):
                    left[f.TURN + 3 * i + j] = director[j, i, node]
            continue
        for c in range(3):
            left[f.PLACE + c] = block[f.ORIGIN + c]
        R = left[f.TURN : f.TURN + 9]
        if motion >= 0:
            for c in range(3):
                left[f.PLACE + c] += row[motion + c]
            exponential(theta, R)
        else:
            R[:] = 0.0
            R[0], R[4], R[8] = 1.0, 1.0, 1.0


@unsigned
def _turn_about_axis(member, R, director, node, out):
    """Write R times the turn about the axis by which the triad has left that of the joint, (9,).

    What has crept in across the axis, an error of the steps, is left out.
    """
    axis, across = member[f.AXIS : f.AXIS + 3], member[f.ACROSS : f.ACROSS + 3]
    around = member[f.AROUND : f.AROUND + 3]
    seen, image = np.zeros(3), np.empty(3)
    for i in range(3):  # the direction ``across`` of the joint's triad, as the rod carries it now
        share = 0.0
        for c in range(3):
            share += member[f.TRIAD + 3 * i + c] * across[c]
        for c in range(3):
            seen[c] += share * director[i, c, node]
    turned_back(R, seen, image)
    x = image[0] * across[0] + image[1] * across[1] + image[2] * across[2]
    y = image[0] * around[0] + image[1] * around[1] + image[2] * around[2]
    angle, theta, own = math.atan2(y, x), np.empty(3), np.empty(9)
    for c in range(3):
        theta[c] = angle * axis[c]
    exponential(theta, own)
    for i in range(3):
        for j in range(3):
            out[3 * i + j] = 0.0
            for k in range(3):
                out[3 * i + j] += R[3 * i + k] * own[3 * k + j]


@part
def place_members(row, fixed, rods, state, loads, velocities):
    """Put every member where its block has it, with the triad that its joint leaves it."""
    position, director = state[0], state[1]
    set_frames(row, fixed, position, director)
    arm, frame = np.empty(3), np.empty(9)
    for q in range(int(fixed[f.MEMBERS])):
        member = member_of(fixed, q)
        node, joint = int(member[f.M_NODE]), int(member[f.JOINT])
        left = left_of_block(fixed, int(member[f.M_BLOCK]))
        R = left[f.TURN : f.TURN + 9]
        turned(R, member[f.ARM : f.ARM + 3], arm)
        rotor = int(member[f.ROTOR])
        for c in range(3):
            position[c, node] = left[f.PLACE + c] + arm[c]
            if rotor >= 0:
                position[c, rotor] = position[c, node]
        if joint == f.CLAMPED:
            for i in range(9):
                frame[i] = R[i]
        elif joint == f.TURNING:
            _turn_about_axis(member, R, director, node, frame)
        else:
            continue
        for i in range(3):
            turned(frame, member[f.TRIAD + 3 * i : f.TRIAD + 3 * i + 3], arm)
            for c in range(3):
                director[i, c, node] = arm[c]
