"""Hooks: the torsion springs between a holder and the end of a rod.

With a rotor that holds twist the spring knows the angle beta between the axis a of the joint and
the direction a' of the rod that lay along it: E = 1/2 k beta^2, and the torque
k beta (a' x a)/|a' x a| turns a' back to a. With a twist modulus too, theta is the rotation vector
from the rotor's triad to that of the rod, E = 1/2 theta . B theta with B = k normal to the axis,
k_t along it, and the torque is its exact gradient,

    m = -(w + 1/2 theta x w + c theta x (theta x w)),    w = B theta,
    c = 1/theta^2 - (1 + cos theta)/(2 theta sin theta)
"""

import math

import numpy as np

from rodsim.blocks import fields as f
from rodsim.blocks.frames import cross, turned
from rodsim.compiled.flags import unsigned


@unsigned
def set_spring(member, left, block_left, director):
    """Leave torque and energy of the spring of a member, 0 without one."""
    left[f.SPRING : f.ENERGY + 1] = 0.0
    if int(member[f.JOINT]) != f.HOOKED:
        return
    axis = np.empty(3)
    turned(block_left[f.TURN : f.TURN + 9], member[f.AXIS : f.AXIS + 3], axis)
    torque = left[f.SPRING : f.SPRING + 3]
    if member[f.TWISTING] > 0.0:
        left[f.ENERGY] = _bend_and_twist(member, block_left, director, axis, torque)
    else:
        left[f.ENERGY] = _bend(member, director, axis, torque)


@unsigned
def _bend(member, director, axis, torque):
    node, own = int(member[f.M_NODE]), np.zeros(3)
    for i in range(3):
        share = 0.0
        for c in range(3):
            share += member[f.TRIAD + 3 * i + c] * member[f.AXIS + c]
        for c in range(3):
            own[c] += share * director[i, c, node]
    cross(own, axis, torque)
    sine = math.sqrt(torque[0] ** 2 + torque[1] ** 2 + torque[2] ** 2)
    cosine = own[0] * axis[0] + own[1] * axis[1] + own[2] * axis[2]
    angle = math.atan2(sine, cosine)
    scale = member[f.BENDING] * (angle / sine if sine > 0.0 else 1.0)
    for c in range(3):
        torque[c] *= scale
    return 0.5 * member[f.BENDING] * angle * angle


@unsigned
def _bend_and_twist(member, block_left, director, axis, torque):
    node, rotor = int(member[f.M_NODE]), int(member[f.ROTOR])
    turn, reference = np.zeros((3, 3)), np.empty(3)
    for i in range(3):
        if rotor >= 0:
            for c in range(3):
                reference[c] = director[i, c, rotor]
        else:
            begin = f.TRIAD + 3 * i
            turned(block_left[f.TURN : f.TURN + 9], member[begin : begin + 3], reference)
        for a in range(3):
            for b in range(3):
                turn[a, b] += director[i, a, node] * reference[b]
    theta = np.empty(3)
    theta[0] = 0.5 * (turn[2, 1] - turn[1, 2])
    theta[1] = 0.5 * (turn[0, 2] - turn[2, 0])
    theta[2] = 0.5 * (turn[1, 0] - turn[0, 1])
    sine = math.sqrt(theta[0] ** 2 + theta[1] ** 2 + theta[2] ** 2)
    angle = math.atan2(sine, 0.5 * (turn[0, 0] + turn[1, 1] + turn[2, 2] - 1.0))
    along, energy = 0.0, 0.0
    for c in range(3):
        theta[c] *= angle / sine if sine > 0.0 else 1.0
        along += theta[c] * axis[c]
    w, once, twice = np.empty(3), np.empty(3), np.empty(3)
    for c in range(3):
        w[c] = member[f.BENDING] * theta[c]
        w[c] += (member[f.TWISTING] - member[f.BENDING]) * along * axis[c]
        energy += 0.5 * theta[c] * w[c]
    coefficient = 1.0 / 12.0 + angle * angle / 720.0
    if angle > 1e-3:
        coefficient = 1.0 / angle**2 - (1.0 + math.cos(angle)) / (2.0 * angle * sine)
    cross(theta, w, once)
    cross(theta, once, twice)
    for c in range(3):
        torque[c] = -(w[c] + 0.5 * once[c] + coefficient * twice[c])
    return energy
