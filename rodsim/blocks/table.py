"""The blocks of a scene as records, and as the numbers that their parts share."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from rodsim.blocks import fields as f
from rodsim.blocks.mobility import (
    Factors,
    factors,
    mobility,
    pair_epsilon,
    rigid_motion,
    self_mobility,
    spins,
)
from rodsim.blocks.surface import SurfacePoints

NO_POINTS = np.zeros((3, 0))


@dataclass(frozen=True)
class Joint:
    """How a member is joined to its block; directions are fixed in the block's frame.

    kind : a joint of :mod:`rodsim.blocks.fields`. axis : of the motor, and of what a stiff hook
    keeps. motor : kind. line : how much torque it loses per rate, 0 without a line.
    bending, twisting : of a hook; twisting 0 is stiff.
    """

    kind: int
    axis: np.ndarray
    motor: int = f.STILL
    line: float = 0.0
    bending: float = 0.0
    twisting: float = 0.0

    @property
    def across(self) -> np.ndarray:
        """Two directions normal to the axis, (2, 3), right-handed with it."""
        least = np.eye(3)[int(np.argmin(np.abs(self.axis)))]
        first = np.cross(self.axis, least)
        first /= np.linalg.norm(first)
        return np.array([first, np.cross(self.axis, first)])

    @property
    def directions(self) -> list[np.ndarray]:
        """The free spins of the member relative to the block; that of a torque motor is last."""
        if self.kind == f.BALL:
            return list(np.eye(3))
        free = []
        if self.kind == f.HOOKED:
            free = list(self.across)
        if self.motor == f.TORQUE or self.twisting > 0.0:
            free.append(self.axis)
        return free

    @property
    def has_rotor(self) -> bool:
        """Whether a rotor turns between the block and a hook that can be twisted."""
        return self.motor == f.RATE and self.twisting > 0.0


@dataclass(frozen=True)
class Member:
    """A held node of a rod: its place (3,) and triad (3, 3) in the frame of its block.

    name : whose end it is, such as "tail.start". rotor : its node, or -1. motor_row : where the
    number of its motor stands.
    """

    name: str
    node: int
    place: np.ndarray
    triad: np.ndarray
    joint: Joint
    rotor: int = -1
    motor_row: int = 0


@dataclass(frozen=True)
class Block:
    """Points that move rigidly together. node : -1 for what holds an end in space.

    origin (3,) : where that is at rest. free : whether it moves as the fluid has it. motion : where
    the numbers of its given motion begin in the row, -1 without.
    """

    name: str
    node: int
    members: tuple[Member, ...]
    surface: SurfacePoints | None = None
    free: bool = False
    motion: int = -1
    origin: np.ndarray = field(default_factory=lambda: np.zeros(3))

    @property
    def points(self) -> np.ndarray:
        """Its surface points, (3, n), in its own frame."""
        return NO_POINTS if self.surface is None else self.surface.points

    @property
    def places(self) -> np.ndarray:
        """Its members, (3, m)."""
        return np.array([m.place for m in self.members], dtype=float).reshape(-1, 3).T.copy()

    @property
    def size(self) -> int:
        """3 n + 6 m."""
        return 3 * self.points.shape[1] + 6 * len(self.members)

    @property
    def axes(self) -> list[tuple[int, np.ndarray]]:
        """The free spins of all its joints: (member, direction)."""
        return [(q, way) for q, m in enumerate(self.members) for way in m.joint.directions]

    @property
    def columns(self) -> int:
        """How many velocities of it are free."""
        return 6 * self.free + len(self.axes)

    def factors(self, blob, epsilon, viscosity) -> Factors:
        """Return the matrices that solve it in free fluid."""
        n, m = self.points.shape[1], len(self.members)
        K = spins(n, m, self.axes)
        if self.free:
            K = np.hstack([rigid_motion(self.points, self.places), K])
        line = [m.joint.line * (way is m.joint.axis) for m in self.members
                for way in m.joint.directions]  # fmt: skip
        line = np.concatenate([np.zeros(6 * self.free), line])
        if n == 0 and m == 1:
            translation, rotation = self_mobility(blob, epsilon, viscosity)
            A = np.diag(np.repeat([translation, rotation], 3))
        else:
            blobs = (self.surface.epsilon, epsilon)
            A = mobility(self.points, self.places, blob, blobs, viscosity)
        return factors(A, K, line)


class Table:
    """Grows the array of :mod:`rodsim.blocks.fields` piece by piece."""

    def __init__(self, begin: int):
        self.blocks, self.end = [], begin

    def add(self, array) -> int:
        """Append numbers, return where they begin."""
        array = np.asarray(array, dtype=float).ravel()
        begin, self.end = self.end, self.end + array.size
        self.blocks.append(array)
        return begin

    def room(self, count: int) -> int:
        """Append so many zeros, return where they begin."""
        return self.add(np.zeros(count))


def numbers_of(blocks, scene, flow=None) -> np.ndarray:
    """Return the array that all parts of the blocks share; ``flow``: numbers of a background."""
    members = [member for block in blocks for member in block.members]
    head, records = np.zeros(f.HEAD), np.zeros((len(blocks), f.BLOCK))
    rows = np.array([_member_record(m) for m in members]).reshape(len(members), f.MEMBER)
    table = Table(f.HEAD + records.size + rows.size)
    first = vector = column = 0
    for b, (block, record) in enumerate(zip(blocks, records, strict=True)):
        rows[first : first + len(block.members), f.M_BLOCK] = b
        spin = 6 * block.free
        for row, member in zip(rows[first:], block.members, strict=False):
            row[f.SPIN], spin = spin, spin + len(member.joint.directions)
        _fill(record, block, table, scene)
        record[[f.FIRST, f.VECTOR, f.COLUMN]] = first, vector, column
        first += len(block.members)
        vector += block.size
        column += block.columns
    motors = sum(member.joint.motor != f.STILL for member in members)
    held = sum(not block.free for block in blocks)
    head[[f.HELD, f.MOTOR_COUNT]] = held, motors
    head[[f.BLOCKS, f.MEMBERS, f.SIZE, f.COLUMNS]] = len(blocks), len(members), vector, column
    head[[f.VISCOSITY, f.EPSILON]] = scene.viscosity, scene.epsilon
    head[f.WALL] = -math.inf if scene.wall is None else scene.wall
    head[f.COUPLED] = len(blocks) > 1 or scene.wall is not None
    if flow is not None:
        head[f.FLOW] = table.add(flow)
        head[f.FLOW_END] = table.end
    head[f.MEMBER_LEFT] = table.room(f.LEFT * len(members))
    head[f.BLOCK_LEFT] = table.room(f.BLOCK_ROOM * len(blocks))
    head[f.VECTORS] = table.room(5 * vector + 2 * column)
    head[f.GAUGES] = table.room(f.HOLDERS + 6 * held + 2 * motors)
    return np.concatenate([head, records.ravel(), rows.ravel(), *table.blocks])


def _fill(record, block, table, scene):
    made = block.factors(scene.blob, scene.epsilon, scene.viscosity)
    n = block.points.shape[1]
    record[f.NODE], record[f.COUNT], record[f.POINTS] = block.node, len(block.members), n
    record[f.FREE], record[f.COLS], record[f.MOTION] = block.free, block.columns, block.motion
    record[f.ORIGIN : f.ORIGIN + 3] = block.origin
    if n:
        record[f.BLOB] = block.surface.epsilon
        record[f.ROD_BLOB] = pair_epsilon(block.surface.epsilon, scene.epsilon)
    record[f.SURFACE], record[f.SKIN] = table.add(block.points), table.room(9 * n)
    places = table.add(made.P), table.add(made.G), table.add(made.inverse)
    record[[f.P, f.G, f.INVERSE]] = places


def _member_record(member):
    row, joint = np.zeros(f.MEMBER), member.joint
    row[f.M_NODE], row[f.ROTOR], row[f.MOTOR_ROW] = member.node, member.rotor, member.motor_row
    row[f.ARM : f.ARM + 3], row[f.TRIAD : f.TRIAD + 9] = member.place, member.triad.ravel()
    row[f.JOINT], row[f.MOTOR], row[f.LINE] = joint.kind, joint.motor, joint.line
    row[f.BENDING], row[f.TWISTING] = joint.bending, joint.twisting
    row[f.AXIS : f.AXIS + 3] = joint.axis
    row[f.ACROSS : f.ACROSS + 3], row[f.AROUND : f.AROUND + 3] = joint.across
    row[f.SPINS] = len(joint.directions)
    for j, way in enumerate(joint.directions):
        row[f.DIRECTIONS + 3 * j : f.DIRECTIONS + 3 * j + 3] = way
    return row
