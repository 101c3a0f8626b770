"""The loads and motions of all blocks at one instant: ``rodsim.blocks.mobility`` has the equations.

One block in free fluid is one product with its matrices. Several blocks, or any at a wall, see each
other: with P and G of each block side by side, and A now the mobility of all of them together,

    L = G Q + d,    d in the range of P,    P (A d + A G Q + v - k) = 0

is solved by conjugate gradients with P as preconditioner (A is symmetric and positive definite), to
1e-10 in the norm of the dissipation, from d = 0: nothing is kept from one evaluation to the next.
"""

import math

import numpy as np

from rodsim.blocks import fields as f
from rodsim.blocks.frames import (
    block_of,
    left_of_block,
    member_of,
    turned,
    turned_back,
)
from rodsim.blocks.motions import subtract_motions
from rodsim.compiled.flags import call_sum, summed, unsigned

CONVERGED = 1e-20  # of the first residual, squared
MOST = 300  # iterations


@summed
def dot(a, b):
    """Return a . b; its order is that of the vector registers, whatever the threads."""
    total = 0.0
    for i in range(np.uint64(a.size)):
        total += a[i] * b[i]
    return total


@unsigned
def surface_points(fixed, block):
    """Return where the surface points of a block are now, (3, n), as its frame was left."""
    n, begin = int(block[f.POINTS]), int(block[f.SKIN])
    return fixed[begin : begin + 3 * n].reshape(3, n)


@unsigned
def surface_loads(fixed, block):
    """Return the loads (6, n) of the surface points of a block, torques 0."""
    n, begin = int(block[f.POINTS]), int(block[f.SKIN])
    return fixed[begin + 3 * n : begin + 9 * n].reshape(6, n)


@unsigned
def vector(fixed, which):
    """Return one of the vectors left over all blocks: loads (0), velocities (1), three more."""
    size = int(fixed[f.SIZE])
    begin = int(fixed[f.VECTORS]) + which * size
    return fixed[begin : begin + size]


@unsigned
def generalised(fixed, which):
    """Return Q (0) or V (1) of all blocks side by side."""
    size, columns = int(fixed[f.SIZE]), int(fixed[f.COLUMNS])
    begin = int(fixed[f.VECTORS]) + 5 * size + which * columns
    return fixed[begin : begin + columns]


@unsigned
def size_of(block):
    """Return d = 3 n + 6 m."""
    return 3 * int(block[f.POINTS]) + 6 * int(block[f.COUNT])


@unsigned
def part_of(x, block):
    """Return a block's part of a vector over all of them."""
    begin = int(block[f.VECTOR])
    return x[begin : begin + size_of(block)]


@unsigned
def columns_of(x, block):
    """Return a block's part of Q or V."""
    begin = int(block[f.COLUMN])
    return x[begin : begin + int(block[f.COLS])]


@unsigned
def apply_P(fixed, x, out):
    """out = P x of every block."""
    for b in range(int(fixed[f.BLOCKS])):
        block = block_of(fixed, b)
        d, begin = size_of(block), int(block[f.P])
        mine, result = part_of(x, block), part_of(out, block)
        for i in range(d):
            result[i] = dot(fixed[begin + i * d : begin + (i + 1) * d], mine)


@unsigned
def apply_G(fixed, q, out):
    """out = G q of every block."""
    for b in range(int(fixed[f.BLOCKS])):
        block = block_of(fixed, b)
        d, c, begin = size_of(block), int(block[f.COLS]), int(block[f.G])
        mine, result = columns_of(q, block), part_of(out, block)
        for i in range(d):
            result[i] = dot(fixed[begin + i * c : begin + (i + 1) * c], mine)


@unsigned
def apply_G_transposed(fixed, x, out):
    """out += G^T x of every block."""
    for b in range(int(fixed[f.BLOCKS])):
        block = block_of(fixed, b)
        d, c, begin = size_of(block), int(block[f.COLS]), int(block[f.G])
        mine, result = part_of(x, block), columns_of(out, block)
        for i in range(d):
            for j in range(c):
                result[j] += fixed[begin + i * c + j] * mine[i]


@unsigned
def spread_loads(fixed, x, loads):
    """Turn loads in blocks' frames into those of surface points, left, and of members (6, m)."""
    own, out = np.empty(3), np.empty(3)
    for b in range(int(fixed[f.BLOCKS])):
        block, R = block_of(fixed, b), left_of_block(fixed, b)[f.TURN : f.TURN + 9]
        mine, n, skin = part_of(x, block), int(block[f.POINTS]), surface_loads(fixed, block)
        for i in range(n):
            for c in range(3):
                own[c] = mine[3 * i + c]
            turned(R, own, out)
            for c in range(3):
                skin[c, i] = out[c]
        for q in range(int(block[f.COUNT])):
            for half in range(0, 6, 3):
                begin = 3 * n + 6 * q + half
                for c in range(3):
                    own[c] = mine[begin + c]
                turned(R, own, out)
                for c in range(3):
                    loads[half + c, int(block[f.FIRST]) + q] = out[c]


@unsigned
def gather(fixed, b, surface, members, x):
    """Turn velocities (3, n) at surface points and (6, m) of members into the block's frame."""
    own, out = np.empty(3), np.empty(3)
    block, R = block_of(fixed, b), left_of_block(fixed, b)[f.TURN : f.TURN + 9]
    mine, n = part_of(x, block), int(block[f.POINTS])
    for i in range(n):
        for c in range(3):
            own[c] = surface[c, i]
        turned_back(R, own, out)
        for c in range(3):
            mine[3 * i + c] = out[c]
    for q in range(int(block[f.COUNT])):
        for half in range(0, 6, 3):
            for c in range(3):
                own[c] = members[half + c, int(block[f.FIRST]) + q]
            turned_back(R, own, out)
            begin = 3 * n + 6 * q + half
            for c in range(3):
                mine[begin + c] = out[c]


@unsigned
def member_places(fixed, position):
    """Return where the members are, (3, m)."""
    places = np.empty((3, int(fixed[f.MEMBERS])))
    for q in range(places.shape[1]):
        for c in range(3):
            places[c, q] = position[c, int(member_of(fixed, q)[f.M_NODE])]
    return places


@unsigned
def add_all(fixed, targets, sources, loads, epsilon, out):
    """Add u and w (6, T) at targets (3, T) by loads (6, n) at sources (3, n)."""
    if targets.shape[1] and sources.shape[1]:
        viscosity, wall = fixed[f.VISCOSITY], fixed[f.WALL]
        address, run = int(fixed[f.SUM]), int(fixed[f.RUN])
        call_sum(address, run, targets, sources, loads, epsilon, viscosity, wall, out)


@unsigned
def add_u(fixed, targets, sources, loads, epsilon, out):
    """Add u (3, T) alone."""
    if targets.shape[1] and sources.shape[1]:
        viscosity, wall = fixed[f.VISCOSITY], fixed[f.WALL]
        address, run = int(fixed[f.SUM_U]), int(fixed[f.RUN_U])
        call_sum(address, run, targets, sources, loads, epsilon, viscosity, wall, out)


@unsigned
def pair_epsilon(block, other):
    """Return the blob size between the surfaces of two blocks."""
    return math.sqrt(0.5 * (block[f.BLOB] ** 2 + other[f.BLOB] ** 2))


@unsigned
def apply_A(fixed, position, x, out):
    """out = A x, the mobility of all blocks together, images at a wall included."""
    places, blocks = member_places(fixed, position), int(fixed[f.BLOCKS])
    loads, velocities = np.empty((6, places.shape[1])), np.zeros((6, places.shape[1]))
    spread_loads(fixed, x, loads)
    add_all(fixed, places, places, loads, fixed[f.EPSILON], velocities)
    for b in range(blocks):
        block = block_of(fixed, b)
        sources, theirs = surface_points(fixed, block), surface_loads(fixed, block)
        add_all(fixed, places, sources, theirs, block[f.ROD_BLOB], velocities)
    for b in range(blocks):
        block = block_of(fixed, b)
        targets = surface_points(fixed, block)
        u = np.zeros_like(targets)
        add_u(fixed, targets, places, loads, block[f.ROD_BLOB], u)
        for c in range(blocks if targets.shape[1] else 0):
            other = block_of(fixed, c)
            sources, theirs = surface_points(fixed, other), surface_loads(fixed, other)
            add_u(fixed, targets, sources, theirs, pair_epsilon(block, other), u)
        gather(fixed, b, u, velocities, out)


@unsigned
def _spin_place(block, q):
    """Return where the angular velocity of member q stands in a vector over all blocks."""
    inside = 3 * int(block[f.POINTS]) + 6 * (q - int(block[f.FIRST])) + 3
    return int(block[f.VECTOR]) + inside


@unsigned
def _line_column(block, member):
    """Return where the rate of a motor stands in V: it is the last spin of its joint."""
    return int(block[f.COLUMN]) + int(member[f.SPIN]) + int(member[f.SPINS]) - 1


@unsigned
def add_lines(fixed, x, out):
    """out += K D^-1 K^T x over motors whose torque falls with their rate: P^+ = A + K D^-1 K^T."""
    for q in range(int(fixed[f.MEMBERS])):
        member = member_of(fixed, q)
        if member[f.LINE] > 0.0:
            begin = _spin_place(block_of(fixed, int(member[f.M_BLOCK])), q)
            axis = member[f.AXIS : f.AXIS + 3]
            share = dot(axis, x[begin : begin + 3]) / member[f.LINE]
            for c in range(3):
                out[begin + c] += share * axis[c]


@unsigned
def _add_line_rates(fixed, V, out):
    """out += K V over the same motors: P takes all other columns of K to 0."""
    for q in range(int(fixed[f.MEMBERS])):
        member = member_of(fixed, q)
        if member[f.LINE] > 0.0:
            block = block_of(fixed, int(member[f.M_BLOCK]))
            begin, rate = _spin_place(block, q), V[_line_column(block, member)]
            for c in range(3):
                out[begin + c] += rate * member[f.AXIS + c]


@unsigned
def _unmet(fixed, Q, L, out):
    """out = Q - K^T L = D V, which is 0 but for the same motors."""
    out[:] = 0.0
    for q in range(int(fixed[f.MEMBERS])):
        member = member_of(fixed, q)
        if member[f.LINE] > 0.0:
            block = block_of(fixed, int(member[f.M_BLOCK]))
            begin, column = _spin_place(block, q), _line_column(block, member)
            out[column] = Q[column] - dot(member[f.AXIS : f.AXIS + 3], L[begin : begin + 3])


@unsigned
def apply_inverse(fixed, q, out):
    """out = N^-1 q of every block."""
    for b in range(int(fixed[f.BLOCKS])):
        block = block_of(fixed, b)
        c, begin = int(block[f.COLS]), int(block[f.INVERSE])
        mine, result = columns_of(q, block), columns_of(out, block)
        for i in range(c):
            result[i] = dot(fixed[begin + i * c : begin + (i + 1) * c], mine)


@unsigned
def solve(fixed, position, w):
    """Leave L and V of all blocks; w : v - k at all their points, in their frames."""
    L, Q, V = vector(fixed, 0), generalised(fixed, 0), generalised(fixed, 1)
    apply_G(fixed, Q, L)
    if fixed[f.COUPLED] == 0.0:
        d = vector(fixed, 2)
        apply_P(fixed, w, d)
        for i in range(np.uint64(L.size)):
            L[i] -= d[i]
        apply_inverse(fixed, Q, V)
        apply_G_transposed(fixed, w, V)
        return
    _conjugate_gradients(fixed, position, w, L)
    # A L + v - k = K V, so V = G^T (A L + v - k) + N^-1 D V.
    total, lines = vector(fixed, 2), np.empty(Q.size)
    apply_A(fixed, position, L, total)
    for i in range(np.uint64(total.size)):
        total[i] += w[i]
    _unmet(fixed, Q, L, lines)
    apply_inverse(fixed, lines, V)
    apply_G_transposed(fixed, total, V)


@unsigned
def _take_off_motions(fixed, x):
    """x -= K G^T x: P takes it to 0, but only to rounding, and it is what rounding grows with."""
    y = np.zeros(int(fixed[f.COLUMNS]))
    apply_G_transposed(fixed, x, y)
    for b in range(int(fixed[f.BLOCKS])):
        block = block_of(fixed, b)
        subtract_motions(fixed, b, columns_of(y, block), part_of(x, block))


@unsigned
def _conjugate_gradients(fixed, position, w, L):
    """Add d to L = G Q; the first residual is -(v - k + A G Q - K N^-1 Q)."""
    residual, z, p, Ap = np.empty(L.size), np.empty(L.size), np.empty(L.size), np.empty(L.size)
    apply_A(fixed, position, L, Ap)
    for i in range(L.size):
        residual[i] = -(Ap[i] + w[i])
    Q = generalised(fixed, 0)
    rates = np.empty(Q.size)
    apply_inverse(fixed, Q, rates)
    _add_line_rates(fixed, rates, residual)
    _take_off_motions(fixed, residual)
    apply_P(fixed, residual, z)
    for i in range(L.size):
        p[i] = z[i]
    rz = dot(residual, z)
    first = rz
    for _ in range(MOST):
        if rz <= CONVERGED * first:
            return
        apply_A(fixed, position, p, Ap)
        add_lines(fixed, p, Ap)
        step = rz / dot(p, Ap)
        for i in range(L.size):
            L[i] += step * p[i]
            residual[i] -= step * Ap[i]
        _take_off_motions(fixed, residual)
        apply_P(fixed, residual, z)
        before, rz = rz, dot(residual, z)
        for i in range(L.size):
            p[i] = z[i] + rz / before * p[i]
    L[:] = math.nan  # it never came to that: the step is rejected
