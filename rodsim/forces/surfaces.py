"""Contact with the surfaces of bodies. Arrays only.

A surface is to a point of a rod what a wall is (:mod:`rodsim.forces.repulsion`): the centreline
touches it at d/2. With s the distance from the surface, n its normal, q = 1 - (2 s/d)^2,

    E = sum (16/35) A d ds_i q^(7/2),    g_i = (64/5) A ds_i (s/d) q^(5/2) n

and the body takes -g_i at X_i, so net force and torque are zero. Other bodies and the wall meet a
body's balls (:mod:`rodsim.forces.balls`): s is the distance of a ball from the surface less its
radius, its weight stands for ds_i, and A is that of the stiffest rod. Of two bodies each is ball
and surface in turn, with half the weight.

``fixed``: d, height of the wall, number of bodies; a record of each body; A ds of each point; runs
of points that a body meets (first, end, rod); balls (x, y, z, radius, A weight).
"""

import math

import numpy as np

from rodsim.compiled.flags import MAT, RODS, TRIADS, VEC, kernel, unsigned
from rodsim.compiled.kernels import part
from rodsim.forces import bodies as f
from rodsim.forces.balls import POINTS, SEGMENT

NEWTON = 40  # steps at most; six are usual


@unsigned
def distance_from(body, p, normal):
    """Return how far p, in the frame of a body, is outside its surface; write the normal there."""
    a, b = body[f.HALF], body[f.RADIUS]
    if body[f.KIND] == SEGMENT:
        z = p[2] - min(max(p[2], -a), a)
        far = math.sqrt(p[0] * p[0] + p[1] * p[1] + z * z)
        over = 1.0 / far if far > 0.0 else 0.0
        normal[0], normal[1], normal[2] = p[0] * over, p[1] * over, z * over
        return far - b
    # The largest root t of G, convex and falling: :mod:`rodsim.blocks.distance` says more.
    z, rho, a2, b2 = abs(p[2]), math.sqrt(p[0] * p[0] + p[1] * p[1]), a * a, b * b
    t = max(a * z - a2, b * rho - b2)
    if min(t + a2, t + b2) <= 0.0:
        normal[:] = 0.0
        return -min(a, b)
    for _ in range(NEWTON):
        u, v = a * z / (t + a2), b * rho / (t + b2)
        step = (u * u + v * v - 1.0) / (2.0 * (u * u / (t + a2) + v * v / (t + b2)))
        t += step
        if abs(step) <= 1e-15 * (abs(t) + a * b):
            break
    normal[0], normal[1], normal[2] = p[0] / (t + b2), p[1] / (t + b2), p[2] / (t + a2)
    size = math.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    for c in range(3):
        normal[c] /= size
    return t * size  # p less its foot is t times the normal before it was made a unit


@unsigned
def _turned(D, node, p, out):
    """Write p of a body's frame in that of the scene."""
    for c in range(3):
        out[c] = D[0, c, node] * p[0] + D[1, c, node] * p[1] + D[2, c, node] * p[2]


@unsigned
def _met(fixed, body, x, radius, weight, state, force, nearest, who):
    """Write the force of a surface on a ball at x, return the energy.

    ``nearest``: the least s so far, and who met there.
    """
    d, node, X, D = fixed[f.DIAMETER], int(body[f.NODE]), state[0], state[1]
    p, normal = np.empty(3), np.empty(3)
    for i in range(3):
        p[i] = 0.0
        for c in range(3):
            p[i] += D[i, c, node] * (x[c] - X[c, node])
    s = distance_from(body, p, normal) - radius
    if s < nearest[0]:
        nearest[0], nearest[1], nearest[2] = s, who, node
    share = s / d
    q = 1.0 - 4.0 * share * share
    if q <= 0.0:
        return 0.0
    root = math.sqrt(q)
    _turned(D, node, normal, force)
    for c in range(3):
        force[c] *= 12.8 * weight * share * q * q * root
    return 16.0 / 35.0 * weight * d * q * q * q * root


@unsigned
def _near(x, X, node, far):
    """Tell whether x is no farther than that from a node."""
    return (x[0] - X[0, node]) ** 2 + (x[1] - X[1, node]) ** 2 + (x[2] - X[2, node]) ** 2 < far**2


@unsigned
def _give(loads, X, node, x, side, force):
    """Add a force at x, times ``side``, to a body."""
    for c in range(3):
        i, j = (c + 1) % 3, (c + 2) % 3
        loads[c, node] += side * force[c]
        arm = (x[i] - X[i, node]) * force[j] - (x[j] - X[j, node]) * force[i]
        loads[3 + c, node] += side * arm


@unsigned
def _places(body, which, size):
    """Return where a body's runs or balls begin in ``fixed``, their number stands behind."""
    begin = int(body[which])
    return range(begin, begin + size * int(body[which + 1]), size)


@unsigned
def _meet_rods(fixed, b, body, state, loads, energies, nearest):
    X, node, far = state[0], int(body[f.NODE]), body[f.BOUND] + 0.5 * fixed[f.DIAMETER]
    x, force, weights = np.empty(3), np.empty(3), f.HEAD + f.BODY * int(fixed[f.BODIES])
    place = energies.size - int(fixed[f.BODIES]) + b
    for begin in _places(body, f.RUNS, f.RUN):
        rod = int(fixed[begin + 2])
        for k in range(int(fixed[begin]), int(fixed[begin + 1])):
            for c in range(3):
                x[c] = X[c, k]
            if not _near(x, X, node, far):
                continue
            weight = fixed[weights + k]
            energy = _met(fixed, body, x, 0.0, weight, state, force, nearest, k)
            if energy > 0.0:
                for c in range(3):
                    loads[c, k] += force[c]
                _give(loads, X, node, x, -1.0, force)
                energies[rod] += 0.5 * energy
                energies[place] += 0.5 * energy


@unsigned
def _meet_balls(fixed, b, body, c, other, state, loads, energies, nearest):
    X, D, node, there = state[0], state[1], int(body[f.NODE]), int(other[f.NODE])
    x, force, d = np.empty(3), np.empty(3), fixed[f.DIAMETER]
    for i in range(3):
        x[i] = X[i, there]
    if not _near(x, X, node, body[f.BOUND] + other[f.BOUND] + 0.5 * d):
        return
    share = 1.0 if other[f.KIND] == POINTS else 0.5
    first = energies.size - int(fixed[f.BODIES])
    for begin in _places(other, f.BALLS, f.BALL):
        ball = fixed[begin : begin + f.BALL]
        _turned(D, there, ball, x)
        for i in range(3):
            x[i] += X[i, there]
        if not _near(x, X, node, body[f.BOUND] + ball[3] + 0.5 * d):
            continue
        weight = share * ball[4]
        energy = _met(fixed, body, x, ball[3], weight, state, force, nearest, there)
        if energy > 0.0:
            _give(loads, X, there, x, 1.0, force)
            _give(loads, X, node, x, -1.0, force)
            energies[first + b] += 0.5 * energy
            energies[first + c] += 0.5 * energy


@unsigned
def _record(fixed, b):
    return fixed[f.HEAD + f.BODY * b : f.HEAD + f.BODY * (b + 1)]


@unsigned
def _meet(fixed, state, loads, energies, nearest):
    """Add the forces of all surfaces to loads (6, N), their energies to those of rods and bodies.

    energies (R + B,): half of each meeting to either side.
    """
    for b in range(int(fixed[f.BODIES])):
        body = _record(fixed, b)
        if body[f.KIND] == POINTS:
            continue
        _meet_rods(fixed, b, body, state, loads, energies, nearest)
        for c in range(int(fixed[f.BODIES])):
            if c != b:
                other = _record(fixed, c)
                _meet_balls(fixed, b, body, c, other, state, loads, energies, nearest)


@unsigned
def _meet_wall(fixed, state, loads, energies, nearest):
    """Add the same of the wall and all balls."""
    X, D, d, arm = state[0], state[1], fixed[f.DIAMETER], np.empty(3)
    for b in range(int(fixed[f.BODIES])):
        body = _record(fixed, b)
        node, place = int(body[f.NODE]), energies.size - int(fixed[f.BODIES]) + b
        if X[2, node] - fixed[f.WALL] >= body[f.BOUND] + 0.5 * d:
            continue
        for begin in _places(body, f.BALLS, f.BALL):
            ball = fixed[begin : begin + f.BALL]
            _turned(D, node, ball, arm)
            s = X[2, node] + arm[2] - fixed[f.WALL] - ball[3]
            if s < nearest[0]:
                nearest[0], nearest[1], nearest[2] = s, node, -1.0
            share = s / d
            q = 1.0 - 4.0 * share * share
            if q > 0.0:
                root = math.sqrt(q)
                push = 12.8 * ball[4] * share * q * q * root
                loads[2, node] += push
                loads[3, node] += arm[1] * push
                loads[4, node] -= arm[0] * push
                energies[place] += 16.0 / 35.0 * ball[4] * d * q * q * q * root


@part
def push_off_bodies(row, fixed, rods, state, loads, velocities):
    """Add the forces between bodies and rods, and between bodies."""
    energies = np.zeros(rods[0].size + int(fixed[f.BODIES]))
    _meet(fixed, state, loads, energies, np.full(3, math.inf))


@part
def push_bodies_off_wall(row, fixed, rods, state, loads, velocities):
    """Add the force of the wall on bodies."""
    energies = np.zeros(rods[0].size + int(fixed[f.BODIES]))
    _meet_wall(fixed, state, loads, energies, np.full(3, math.inf))


@kernel(f"void({VEC}, {RODS}, {MAT}, {TRIADS}, {VEC}, {VEC})")
def meetings(fixed, rods, X, D, energies, nearest):
    """Add to ``energies`` (R + B,); write who is nearest to a surface: s, who, whose, -1: the wall.

    Of what is nearer than d/2; else ``nearest`` stays as it is.
    """
    loads, state = np.zeros((6, X.shape[1])), (X, D, X)
    _meet(fixed, state, loads, energies, nearest)
    _meet_wall(fixed, state, loads, energies, nearest)
