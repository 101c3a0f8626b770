"""A slow, obvious twin of rigid blocks: all of a scene as one dense saddle-point system,

    [ A  -K ] [L]   [k - v]
    [ K^T D ] [V] = [  Q  ]

in the lab frame: no factors, no iteration, no code of ``rodsim/blocks``. Places and joints are read
from the case; springs push by differences of their energy; only the surfaces' points and the loads
of the rods are taken from rodsim.
"""

from dataclasses import dataclass, field

import numpy as np
import twins
from scipy.spatial.transform import Rotation

from rodsim import velocity
from rodsim.scene.evaluation import loads_of

STEP = 1e-6  # of differences, rad


@dataclass
class Member:
    """A held node of a rod: its end of the case, where it is, the free spins of its joint."""

    node: int
    end: object
    arm: np.ndarray
    axis: np.ndarray
    reference: np.ndarray
    rotor: int = -1
    spins: list = field(default_factory=list)


@dataclass
class Block:
    """Points that move together about ``centre``; ``given`` (6,): its motion, None if free."""

    centre: np.ndarray
    turn: np.ndarray
    given: np.ndarray | None
    outside: np.ndarray
    surface: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    epsilon: float = 0.0
    node: int = -1
    members: list = field(default_factory=list)


@dataclass
class Answer:
    """Velocities and loads (6, N) of all nodes; what holds blocks, torque and rate of motors."""

    velocities: np.ndarray
    loads: np.ndarray
    holders: list
    motors: list


def mobility(x, X, epsilons, viscosity, blob):
    """Return the matrix (6 T, 6 S) of u and w at x (T, 3) by loads at X (S, 3)."""
    d = x[:, None] - X[None]
    h1, h2, q, d1, d2 = twins.scalars(blob, np.linalg.norm(d, axis=2), epsilons)
    eye, dd = np.eye(3), d[..., :, None] * d[..., None, :]
    cross = np.zeros((*d.shape[:2], 3, 3))  # cross @ n = n x d
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        cross[..., i, j], cross[..., i, k] = d[..., k], -d[..., j]
    out = np.zeros((*d.shape[:2], 6, 6))
    out[..., :3, :3] = h1[..., None, None] * eye + h2[..., None, None] * dd
    out[..., :3, 3:] = out[..., 3:, :3] = 0.5 * q[..., None, None] * cross
    out[..., 3:, 3:] = 0.25 * (d1[..., None, None] * eye + d2[..., None, None] * dd)
    return out.transpose(0, 2, 1, 3).reshape(6 * len(x), 6 * len(X)) / viscosity


def at_wall(x, X, epsilons, viscosity, blob, wall):
    """The same above a wall, from the library's sums, one source and one component at a time."""
    out = np.zeros((len(x), 6, len(X), 6))
    for t, s in np.ndindex(len(x), len(X)):
        for c, load in enumerate(np.eye(6)):
            u, w = velocity(x[t : t + 1], X[s : s + 1], [load[:3]], [load[3:]], epsilons[t, s],
                            viscosity, blob=blob, wall=wall)  # fmt: skip
            out[t, :, s, c] = [*u[0], *w[0]]
    return out.reshape(6 * len(x), 6 * len(X))


def at(value, t):
    return float(value(0.0, t)) if callable(value) else float(value)


def rate(values, t, step=1e-5):
    after, before = (np.array([at(v, t + h) for v in values]) for h in (step, -step))
    return (after - before) / (2 * step)


def turning(values, t, step=1e-5):
    """Return the rotation of a rotation vector of time, and its angular velocity by differences."""
    now, after, before = (
        Rotation.from_rotvec([at(v, t + h) for v in values]) for h in (0.0, step, -step)
    )
    return now.as_matrix(), (after * before.inv()).as_rotvec() / (2 * step)


def blocks_of(case, system, state, t):
    """Return the blocks of a case at a state: bodies, then each end held in space."""
    scene, start = system.scene, system.scene.initial
    blocks, by_name = [], {}
    for body in scene.bodies:
        words = case.bodies[body.name]
        R = state.director[:, :, body.node].T
        outside = np.array([at(v, t) for v in (*words.force, *words.torque)])
        given = None if words.motion == "free" else np.zeros(6)
        if not isinstance(words.motion, str):
            given[:3] = [at(v, t) for v in words.motion.velocity]
            if words.motion.spin is not None:
                given[3:] = [at(v, t) for v in words.motion.spin]
        X = state.position[:, body.node]
        surface = X + (R @ body.surface.points).T
        block = Block(X, R, given, outside, surface, body.surface.epsilon, body.node)
        blocks.append(block)
        by_name[body.name] = block, body.centre, body.turn
    rotor = scene.rods.points + len(scene.bodies)
    for name, words in case.rods.items():
        rod = scene.rods[scene.rods.names.index(name)]
        for end, node in ((words.start, rod.first), (words.end, rod.first + rod.count - 1)):
            if end is None or end.hold == "free":
                continue
            place, triad = start.position[:, node], start.director[:, :, node]
            if end.to != "space":
                block, centre, turn = by_name[end.to]
                R = block.turn @ turn.T
            else:
                R, moved, given = np.eye(3), np.zeros(3), np.zeros(6)
                centre = place
                if end.move is not None:  # these cases are at rest in their place at t = 0
                    R, given[3:] = turning(end.move.turn, t)
                    given[:3] = rate(end.move.displace, t)
                    moved = np.array([at(v, t) for v in end.move.displace])
                block = Block(place + moved, R, given, np.zeros(6))
                blocks.append(block)
            axis = triad[2]
            if end.motor is not None and end.motor.axis is not None:
                axis = np.array(end.motor.axis) / np.linalg.norm(end.motor.axis)
            member = Member(node, end, R @ (place - centre), R @ axis, triad @ R.T)
            if (
                end.hook
                and end.motor
                and end.motor.rate is not None
                and end.hook.twisting != "stiff"
            ):
                member.rotor, rotor = rotor, rotor + 1
            block.members.append(member)
            _set_spins(member)
            _place(member, block, state)
    return blocks


def driven(end):
    """Tell whether a motor of given torque turns an end."""
    return end.motor is not None and end.motor.torque is not None


def _set_spins(member):
    end, a = member.end, member.axis
    across = np.linalg.svd(a[None])[2][1:]
    if end.hold == "hinged":
        member.spins = list(np.eye(3))
    elif end.hook is not None:
        member.spins = [*across]
        if driven(end) or end.hook.twisting != "stiff":
            member.spins.append(a)
    elif driven(end):
        member.spins = [a]


def _place(member, block, state):
    """Put the node where its block has it; a clamped one follows it, or turns about its axis."""
    state.position[:, member.node] = block.centre + member.arm
    if member.rotor >= 0:
        state.position[:, member.rotor] = block.centre + member.arm
    end = member.end
    if end.hold == "clamped" and end.hook is None:
        triad = member.reference
        if end.motor is not None:
            turn = Rotation.from_matrix(state.director[:, :, member.node].T @ triad)
            # the turn about the axis that comes nearest to the triad the rod has
            w, v = turn.as_quat()[3], turn.as_quat()[:3] @ member.axis
            triad = triad @ Rotation.from_rotvec(2 * np.arctan2(v, w) * member.axis).as_matrix().T
        state.director[:, :, member.node] = triad


def hook_energy(member, state, turn=(0.0, 0.0, 0.0)):
    """Return the energy of a hook when its member is turned a little further."""
    hook, end = member.end.hook, member.end
    own = state.director[:, :, member.node] @ Rotation.from_rotvec(turn).as_matrix().T
    if hook.twisting == "stiff" or driven(end):
        direction = own.T @ (member.reference @ member.axis)
        angle = np.arctan2(
            np.linalg.norm(np.cross(direction, member.axis)), direction @ member.axis
        )
        return 0.5 * hook.bending * angle**2
    reference = member.reference if member.rotor < 0 else state.director[:, :, member.rotor]
    theta = Rotation.from_matrix(own.T @ reference).as_rotvec()
    along = theta @ member.axis
    return 0.5 * hook.bending * (theta @ theta - along**2) + 0.5 * hook.twisting * along**2


def hook_torque(member, state):
    """Return minus the slope of its energy, by differences of order 4."""
    if member.end.hook is None:
        return np.zeros(3)

    def energy(i, h):
        return hook_energy(member, state, h * np.eye(3)[i])

    h = 1e-3
    return np.array([
        -(8 * (energy(i, h) - energy(i, -h)) - energy(i, 2 * h) + energy(i, -2 * h)) / (12 * h)
        for i in range(3)
    ])  # fmt: skip


def solve(case, system, state, t, flow=None):
    """Return the answer at a state, which is put in its place; flow(x, t): u (3,) far away."""
    scene = system.scene
    blocks = blocks_of(case, system, state, t)
    passed = loads_of(scene, state)
    passed[:, scene.rods.points :] = 0.0
    members = [m for b in blocks for m in b.members]
    free = np.setdiff1d(np.arange(scene.rods.points), [m.node for m in members])
    X, e, torque, rows, K, k, Q, D = _system(scene, blocks, state, passed, t)
    nodes = state.position[:, free].T
    targets = np.concatenate([X, nodes])
    sizes = np.concatenate([e, np.full(len(free), scene.epsilon)])
    sources, pair = targets, np.sqrt(0.5 * (sizes[:, None] ** 2 + sizes**2))
    arguments = sources, pair, scene.viscosity, scene.blob
    if scene.wall is None:
        M = mobility(targets, *arguments)
    else:
        M = at_wall(targets, *arguments, scene.wall)
    far = np.concatenate([_far(flow, x, t) for x in targets])
    d, known = 6 * len(X), passed[:, free].T.ravel()
    keep = np.repeat(torque, 6) | np.tile([True] * 3 + [False] * 3, len(X))  # of the loads
    v = (M[:d, d:] @ known + far[:d])[keep]
    A, K, k = M[:d, :d][np.ix_(keep, keep)], K[keep], k[keep]
    matrix = np.block([[A, -K], [K.T, D]])
    found = np.linalg.solve(matrix, np.concatenate([k - v, Q]))
    L = np.zeros(d)
    L[keep], V = found[: keep.sum()], found[keep.sum() :]
    everywhere = (M[d:] @ np.concatenate([L, known]) + far[d:]).reshape(-1, 6).T
    return _answer(scene, blocks, state, passed, free, everywhere, L.reshape(-1, 6), V, rows, t)


def _far(flow, x, t, h=1e-4):
    if flow is None:
        return np.zeros(6)
    slope = np.array([(flow(x + h * a, t) - flow(x - h * a, t)) / (2 * h) for a in np.eye(3)])
    curl = [slope[1, 2] - slope[2, 1], slope[2, 0] - slope[0, 2], slope[0, 1] - slope[1, 0]]
    return np.concatenate([flow(x, t), 0.5 * np.array(curl)])


def _rigid(arm):
    """Return u and w (6, 6) at an arm from the centre, by U and Omega."""
    out = np.eye(6)
    out[:3, 3:] = np.cross(np.eye(3), arm).T  # Omega x arm
    return out


def _system(scene, blocks, state, passed, t):
    X, e, torque, rigid, given, Q = [], [], [], [], [], []
    columns = sum(6 * (b.given is None) + sum(len(m.spins) for m in b.members) for b in blocks)
    D, begin, rows = np.zeros((columns, columns)), 0, []
    for block in blocks:
        first = begin
        if block.given is None:
            begin += 6
            total = block.outside.copy()
            for m in block.members:
                g = passed[:, m.node]
                total += np.concatenate([g[:3], np.cross(m.arm, g[:3]) + g[3:]])
            Q += list(total)
        points = [(p - block.centre, None) for p in block.surface]
        for arm, m in points + [(m.arm, m) for m in block.members]:
            row, own = np.zeros((6, columns)), np.zeros(6)
            if block.given is None:
                row[:, first : first + 6] = _rigid(arm)
            else:
                own = _rigid(arm) @ block.given
            if m is not None:
                begin = _joint(m, state, passed, row, own, Q, D, begin, t)
            X.append(block.centre + arm)
            e.append(scene.epsilon if m is not None else block.epsilon)
            torque.append(m is not None)
            rigid.append(row)
            given.append(own)
        rows.append(first)
    return (np.array(X), np.array(e), np.array(torque), rows, np.concatenate(rigid),
            np.concatenate(given), np.array(Q), D)  # fmt: skip


def _joint(m, state, passed, row, own, Q, D, begin, t):
    """Add the spins of a joint to the velocity of its member; return where the next ones begin."""
    motor = m.end.motor
    if motor is not None and motor.rate is not None and m.rotor < 0:
        own[3:] += at(motor.rate, t) * m.axis
    push = passed[3:, m.node] + hook_torque(m, state)
    for spin in m.spins:
        row[3:, begin] = spin
        Q.append(spin @ push)
        if spin is m.axis and motor is not None and motor.torque is not None:
            Q[-1] += at(motor.torque, t)
            if motor.free_rate is not None:
                D[begin, begin] = motor.torque / motor.free_rate
        begin += 1
    return begin


def _answer(scene, blocks, state, passed, free, everywhere, L, V, rows, t):
    out, loads = np.zeros((6, scene.nodes)), np.zeros((6, scene.nodes))
    out[:, free], loads[:, free] = everywhere, passed[:, free]
    holders, motors, at_point, begin = [], [], 0, 0
    for block, first in zip(blocks, rows, strict=True):
        motion = V[first : first + 6] if block.given is None else block.given
        begin = first + 6 * (block.given is None)
        body, n = np.zeros(6), len(block.surface)
        for p, f in zip(block.surface, L[at_point : at_point + n], strict=True):
            body += np.concatenate([f[:3], np.cross(p - block.centre, f[:3])])
        at_point += n
        total = body - block.outside
        if block.node >= 0:
            out[:, block.node], loads[:, block.node] = motion, body
        for m in block.members:
            load, g = L[at_point], passed[:, m.node]
            at_point += 1
            out[:, m.node] = _rigid(m.arm) @ motion
            spin = np.zeros(3)
            motor = m.end.motor
            if motor is not None and motor.rate is not None and m.rotor < 0:
                spin += at(motor.rate, t) * m.axis
            for way in m.spins:
                spin += V[begin] * way
                begin += 1
            out[3:, m.node] += spin
            if m.rotor >= 0:
                out[:, m.rotor] = out[:, m.node]
                out[3:, m.rotor] = motion[3:] + at(motor.rate, t) * m.axis
            loads[:, m.node] = load
            more = load - g
            total[:3] += more[:3]
            total[3:] += np.cross(m.arm, more[:3]) + more[3:]
            if motor is not None:
                motors.append(_motor(motor, m, spin, more, t))
        if block.given is not None:
            holders.append(total)
    return Answer(out, loads, holders, motors)


def _motor(motor, m, spin, more, t):
    if motor.rate is not None:
        return m.axis @ more[3:], at(motor.rate, t)
    torque, seen = at(motor.torque, t), spin @ m.axis
    line = 0.0 if motor.free_rate is None else motor.torque / motor.free_rate
    return torque - line * seen, seen
