"""The parts of blocks: loads are taken off what is held, then found anew so that it holds."""

import math

import numpy as np

from rodsim.blocks import fields as f
from rodsim.blocks.frames import (
    block_of,
    cross,
    left_of_block,
    left_of_member,
    member_of,
    set_frames,
    turned,
    turned_back,
)
from rodsim.blocks.joints import set_spring
from rodsim.blocks.solve import (
    add_all,
    add_u,
    columns_of,
    dot,
    gather,
    generalised,
    member_places,
    part_of,
    solve,
    spread_loads,
    surface_loads,
    surface_points,
    vector,
)
from rodsim.compiled.flags import unsigned
from rodsim.compiled.kernels import part
from rodsim.flows.carried import carry


@part
def release(row, fixed, rods, state, loads, velocities):
    """Take the loads off members and bodies; leave what each block has to pass on, Q."""
    set_frames(row, fixed, state[0], state[1])
    for b in range(int(fixed[f.BLOCKS])):
        _place_surface(fixed, b)
        node, left = int(block_of(fixed, b)[f.NODE]), left_of_block(fixed, b)
        left[f.OUTSIDE : f.OUTSIDE + 6] = 0.0
        if node >= 0:
            for c in range(6):
                left[f.OUTSIDE + c] = loads[c, node]
                loads[c, node] = 0.0
    for q in range(int(fixed[f.MEMBERS])):
        member, left = member_of(fixed, q), left_of_member(fixed, q)
        node = int(member[f.M_NODE])
        set_spring(member, left, left_of_block(fixed, int(member[f.M_BLOCK])), state[1])
        for c in range(6):
            left[f.LOAD + c] = loads[c, node]
            loads[c, node] = 0.0
    _set_Q(row, fixed, state[0])


@unsigned
def _place_surface(fixed, b):
    block, left = block_of(fixed, b), left_of_block(fixed, b)
    n, begin, R = int(block[f.POINTS]), int(block[f.SURFACE]), left[f.TURN : f.TURN + 9]
    own, now = fixed[begin : begin + 3 * n].reshape(3, n), surface_points(fixed, block)
    for c in range(3):
        for i in range(n):
            arm = R[3 * c] * own[0, i] + R[3 * c + 1] * own[1, i] + R[3 * c + 2] * own[2, i]
            now[c, i] = left[f.PLACE + c] + arm


@unsigned
def _resultant(fixed, b, position, loads, total):
    """Write the force and the torque about its place of the members' loads on block b."""
    block, left = block_of(fixed, b), left_of_block(fixed, b)
    arm, moment = np.empty(3), np.empty(3)
    total[:] = 0.0
    for q in range(int(block[f.FIRST]), int(block[f.FIRST]) + int(block[f.COUNT])):
        node = int(member_of(fixed, q)[f.M_NODE])
        for c in range(3):
            arm[c] = position[c, node] - left[f.PLACE + c]
        cross(arm, loads[:3, q], moment)
        for c in range(3):
            total[c] += loads[c, q]
            total[3 + c] += loads[3 + c, q] + moment[c]


@unsigned
def _member_loads(fixed):
    """Return the loads (6, m) that the members have from their rods."""
    loads = np.empty((6, int(fixed[f.MEMBERS])))
    for q in range(loads.shape[1]):
        left = left_of_member(fixed, q)
        for c in range(6):
            loads[c, q] = left[f.LOAD + c]
    return loads


@unsigned
def _set_Q(row, fixed, position):
    """Leave Q in the blocks' frames: what a block passes on, then the torques of its joints."""
    Q, total, passed, own = generalised(fixed, 0), np.empty(6), _member_loads(fixed), np.empty(3)
    for b in range(int(fixed[f.BLOCKS])):
        block, left = block_of(fixed, b), left_of_block(fixed, b)
        R, mine = left[f.TURN : f.TURN + 9], columns_of(Q, block)
        if block[f.FREE] != 0.0:
            _resultant(fixed, b, position, passed, total)
            for c in range(6):
                total[c] += left[f.OUTSIDE + c]
            turned_back(R, total[:3], mine[:3])
            turned_back(R, total[3:], mine[3:6])
        for q in range(int(block[f.FIRST]), int(block[f.FIRST]) + int(block[f.COUNT])):
            member, kept = member_of(fixed, q), left_of_member(fixed, q)
            for c in range(3):
                own[c] = kept[f.LOAD + 3 + c] + kept[f.SPRING + c]
            turned_back(R, own, own)
            if int(member[f.MOTOR]) == f.TORQUE:
                for c in range(3):
                    own[c] += row[int(member[f.MOTOR_ROW])] * member[f.AXIS + c]
            for j in range(int(member[f.SPINS])):
                begin = f.DIRECTIONS + 3 * j
                mine[int(member[f.SPIN]) + j] = dot(member[begin : begin + 3], own)


@part
def hold(row, fixed, rods, state, loads, velocities):
    """Find the loads of all blocks, add what they do to the fluid, move members with them."""
    position, out = state[0], velocities[0]
    w, carried = vector(fixed, 3), vector(fixed, 4)
    _given_velocities(row, fixed, position, loads, out, w, carried)
    solve(fixed, position, w)
    L, places = vector(fixed, 0), member_places(fixed, position)
    held = np.empty((6, places.shape[1]))
    spread_loads(fixed, L, held)
    add_all(fixed, position, places, held, fixed[f.EPSILON], out)
    for b in range(int(fixed[f.BLOCKS])):
        block = block_of(fixed, b)
        sources, theirs = surface_points(fixed, block), surface_loads(fixed, block)
        add_all(fixed, position, sources, theirs, block[f.ROD_BLOB], out)
    gauges = fixed[int(fixed[f.GAUGES]) :]
    gauges[:] = 0.0
    _set_motions(row, fixed, position, held, loads, out, gauges)
    _set_stresslets(row, fixed, L, carried, loads, gauges)


@unsigned
def _given_velocities(row, fixed, position, loads, out, w, carried):
    """Write v - k at all points of blocks, and the background flow at surfaces, in their frames."""
    members = np.empty((6, int(fixed[f.MEMBERS])))
    for q in range(members.shape[1]):
        node = int(member_of(fixed, q)[f.M_NODE])
        for c in range(6):
            members[c, q] = out[c, node]
    none, begin = np.zeros_like(members), int(fixed[f.FLOW])
    carried[:] = 0.0
    for b in range(int(fixed[f.BLOCKS])):
        block = block_of(fixed, b)
        targets = surface_points(fixed, block)
        u, far = np.zeros_like(targets), np.zeros_like(targets)
        add_u(fixed, targets, position, loads, block[f.ROD_BLOB], u)
        if targets.shape[1] and begin > 0:
            carry(fixed[begin : int(fixed[f.FLOW_END])], row[0], targets, far)
            gather(fixed, b, far, none, carried)
            for c in range(3):
                for i in range(targets.shape[1]):
                    u[c, i] += far[c, i]
        gather(fixed, b, u, members, w)
        _subtract_given(row, fixed, b, w)


@unsigned
def _subtract_given(row, fixed, b, w):
    """w -= k: the given motion of a block that is not free, and the given rates of motors."""
    block, left = block_of(fixed, b), left_of_block(fixed, b)
    R, n, mine = left[f.TURN : f.TURN + 9], int(block[f.POINTS]), part_of(w, block)
    U, spin, u = np.zeros(3), np.zeros(3), np.empty(3)
    if block[f.FREE] == 0.0:
        turned_back(R, left[f.GIVEN : f.GIVEN + 3], U)
        turned_back(R, left[f.GIVEN + 3 : f.GIVEN + 6], spin)
    begin = int(block[f.SURFACE])
    own = fixed[begin : begin + 3 * n].reshape(3, n)
    for i in range(n):
        cross(spin, own[:, i], u)
        for c in range(3):
            mine[3 * i + c] -= U[c] + u[c]
    for q in range(int(block[f.COUNT])):
        member, at = member_of(fixed, int(block[f.FIRST]) + q), 3 * n + 6 * q
        cross(spin, member[f.ARM : f.ARM + 3], u)
        rate = _given_rate(row, member)
        for c in range(3):
            mine[at + c] -= U[c] + u[c]
            mine[at + 3 + c] -= spin[c] + rate * member[f.AXIS + c]


@unsigned
def _given_rate(row, member):
    """Return the rate at which a motor turns the member itself: not that of a rotor behind it."""
    if int(member[f.MOTOR]) == f.RATE and member[f.ROTOR] < 0.0:
        return row[int(member[f.MOTOR_ROW])]
    return 0.0


@unsigned
def _set_motions(row, fixed, position, held, loads, out, gauges):
    """Set velocities and loads of members and bodies; leave motors, holders and their power."""
    V, passed, total = generalised(fixed, 1), _member_loads(fixed), np.empty(6)
    U, spin, axis, own = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    holder, held_count = f.HOLDERS, int(fixed[f.HELD])
    motor, motors = f.HOLDERS + 6 * held_count, int(fixed[f.MOTOR_COUNT])
    for b in range(int(fixed[f.BLOCKS])):
        block, left = block_of(fixed, b), left_of_block(fixed, b)
        R, rates = left[f.TURN : f.TURN + 9], columns_of(V, block)
        for c in range(3):
            U[c], spin[c] = left[f.GIVEN + c], left[f.GIVEN + 3 + c]
        if block[f.FREE] != 0.0:
            turned(R, rates[:3], U)
            turned(R, rates[3:6], spin)
        _set_body(fixed, b, position, held, passed, U, spin, loads, out, total)
        if block[f.FREE] == 0.0:
            for c in range(3):
                gauges[holder + c], gauges[holder + 3 * held_count + c] = total[c], total[3 + c]
            holder += 3
            gauges[f.ANCHORS] += dot(total[:3], U) + dot(total[3:], spin)
        for q in range(int(block[f.FIRST]), int(block[f.FIRST]) + int(block[f.COUNT])):
            member, kept, node = member_of(fixed, q), left_of_member(fixed, q), 0
            node, rotor = int(member[f.M_NODE]), int(member[f.ROTOR])
            for c in range(3):
                own[c] = position[c, node] - left[f.PLACE + c]
            cross(spin, own, own)
            turned(R, member[f.AXIS : f.AXIS + 3], axis)
            for c in range(3):
                out[c, node] = U[c] + own[c]
                loads[c, node], loads[3 + c, node] = held[c, q], held[3 + c, q]
            _set_spin(row, member, R, rates, spin, node, out)
            if rotor >= 0:
                for c in range(3):
                    out[c, rotor] = out[c, node]
                    out[3 + c, rotor] = spin[c] + row[int(member[f.MOTOR_ROW])] * axis[c]
            if int(member[f.MOTOR]) != f.STILL:
                _set_motor(row, member, kept, axis, spin, out, held[3:, q])
                gauges[f.MOTORS] += kept[f.MOTOR_TORQUE] * kept[f.MOTOR_RATE]
                gauges[motor], gauges[motor + motors] = kept[f.MOTOR_TORQUE], kept[f.MOTOR_RATE]
                motor += 1


@unsigned
def _set_body(fixed, b, position, held, passed, U, spin, loads, out, total):
    """Set a body's velocity and load; leave in ``total`` what holds the block from outside."""
    block, left = block_of(fixed, b), left_of_block(fixed, b)
    _resultant(fixed, b, position, held, total)
    moment = np.empty(6)
    _resultant(fixed, b, position, passed, moment)
    surface, theirs = surface_points(fixed, block), surface_loads(fixed, block)
    force, torque, arm = np.zeros(3), np.zeros(3), np.empty(3)
    for i in range(surface.shape[1]):
        for c in range(3):
            arm[c] = surface[c, i] - left[f.PLACE + c]
            force[c] += theirs[c, i]
        cross(arm, theirs[:3, i], arm)
        for c in range(3):
            torque[c] += arm[c]
    for c in range(3):
        total[c] += force[c] - moment[c] - left[f.OUTSIDE + c]
        total[3 + c] += torque[c] - moment[3 + c] - left[f.OUTSIDE + 3 + c]
    for c in range(6):
        left[f.HOLDER + c] = total[c]
    node = int(block[f.NODE])
    if node >= 0:
        for c in range(3):
            out[c, node], out[3 + c, node] = U[c], spin[c]
            loads[c, node], loads[3 + c, node] = force[c], torque[c]
        for i in range(surface.shape[1]):
            if not surface[2, i] > fixed[f.WALL]:
                out[:, node] = math.nan


@unsigned
def _set_spin(row, member, R, rates, spin, node, out):
    """Set the angular velocity of a member: that of its block, and the spins of its joint."""
    own, turn = np.empty(3), np.empty(3)
    rate = _given_rate(row, member)
    for c in range(3):
        own[c] = rate * member[f.AXIS + c]
    for j in range(int(member[f.SPINS])):
        for c in range(3):
            own[c] += rates[int(member[f.SPIN]) + j] * member[f.DIRECTIONS + 3 * j + c]
    turned(R, own, turn)
    for c in range(3):
        out[3 + c, node] = spin[c] + turn[c]


@unsigned
def _set_motor(row, member, kept, axis, spin, out, torque):
    """Leave torque and rate of a motor."""
    node, value = int(member[f.M_NODE]), row[int(member[f.MOTOR_ROW])]
    if int(member[f.MOTOR]) == f.RATE:
        kept[f.MOTOR_RATE] = value
        kept[f.MOTOR_TORQUE] = 0.0
        for c in range(3):
            kept[f.MOTOR_TORQUE] += axis[c] * (torque[c] - kept[f.LOAD + 3 + c])
        return
    kept[f.MOTOR_RATE] = 0.0
    for c in range(3):
        kept[f.MOTOR_RATE] += axis[c] * (out[3 + c, node] - spin[c])
    kept[f.MOTOR_TORQUE] = value - member[f.LINE] * kept[f.MOTOR_RATE]


@unsigned
def _set_stresslets(row, fixed, L, carried, loads, gauges):
    """Leave what the power of a background flow on surfaces is beyond that at the bodies' centres.

    -sum lambda.u_inf over the surface, less -(F.u_inf + T.w_inf) at the node, which the ledger has.
    """
    begin = int(fixed[f.FLOW])
    if begin == 0:
        return
    gauges[f.STRESSLETS] = -dot(L, carried)
    place, far = np.empty((3, 1)), np.empty((6, 1))
    for b in range(int(fixed[f.BLOCKS])):
        node, left = int(block_of(fixed, b)[f.NODE]), left_of_block(fixed, b)
        if node >= 0:
            for c in range(3):
                place[c, 0] = left[f.PLACE + c]
            far[:] = 0.0
            carry(fixed[begin : int(fixed[f.FLOW_END])], row[0], place, far)
            for c in range(6):
                gauges[f.STRESSLETS] += far[c, 0] * loads[c, node]


@part
def stir(row, fixed, rods, state, loads, velocities):
    """Add what the surfaces of bodies do to tracers."""
    for b in range(int(fixed[f.BLOCKS])):
        block = block_of(fixed, b)
        sources, theirs = surface_points(fixed, block), surface_loads(fixed, block)
        add_u(fixed, state[2], sources, theirs, block[f.BLOB], velocities[1])
