"""Bodies, and how ends of rods are held, in words and as parts of a scene.

Rigid blocks by constraint, not by springs: the fastest rate of a scene does not rise. Equations:
:mod:`rodsim.blocks.mobility`; the four parts, in the order in which they act:

    place     members go where their block has them
    release   their loads go to the block, Q
    hold      loads L on the fluid and motions V are found, after the flows of all else
    stir      tracers feel the surfaces
"""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
from pydantic import AfterValidator

from rodsim.blocks.check import HELD_IN, check
from rodsim.blocks.ends import ENDS, end_node, held_ends, winds_up
from rodsim.blocks.words import Body, End, Motion
from rodsim.case.expressions import Expression
from rodsim.case.fields import Name, not_empty
from rodsim.compiled.parts import FORCE, HOLD, PLACE, RELEASE, TRACERS, Part
from rodsim.compiled.row import Entry, Row
from rodsim.errors import CaseError
from rodsim.flows.fluid import pair_sum
from rodsim.forces.places import rod_named
from rodsim.registry import Kind

AT = np.zeros(1)  # what is driven here does not depend on s
LOOKED_AT = np.linspace(0.0, 1.0, 12)  # of the run: when it is checked


class _Rows:
    """Gives out places in the row that all parts of the blocks share."""

    def __init__(self):
        self.size, self.entries, self.watched = 1, [], []  # the first number is the time

    def add(self, values, watch: bool, group) -> int:
        """Add numbers or expressions in t, return where they begin."""
        begin, self.size = self.size, self.size + len(values)
        for place, value in enumerate(values, begin):
            entry = Entry(value, AT, place, group)
            self.entries.append(entry)
            if watch and entry.driven:
                self.watched.append(entry)
        return begin


def _rates(values):
    return [v.derivative("t") if isinstance(v, Expression) else 0.0 for v in values]


def _given(rows, place, turn, group, rates=None) -> int:
    """Add a given motion: displacement, its rate, rotation vector, its rate."""
    begin = rows.add(place, True, (*group, "displace"))
    rows.add(_rates(place) if rates is None else rates, rates is not None, (*group, "velocity"))
    rows.add(turn[0], True, (*group, "turn"))
    rows.add(turn[1], False, (*group, "spin"))
    return begin


def _joint(end, director):
    """Return the joint of an end; ``director`` (3, 3): its triad in the frame of its holder."""
    from rodsim.blocks import fields as f
    from rodsim.blocks.table import Joint

    axis = director[2]
    motor, line = f.STILL, 0.0
    if end.motor is not None:
        motor = f.TORQUE if end.motor.rate is None else f.RATE
        if end.motor.free_rate is not None:
            line = end.motor.torque / end.motor.free_rate
    if end.hold == "hinged":
        return Joint(f.BALL, axis)
    if end.hook is None:
        return Joint(f.CLAMPED if motor == f.STILL else f.TURNING, axis, motor, line)
    stiff = end.hook.twisting == "stiff" or motor == f.TORQUE
    twisting = 0.0 if stiff else end.hook.twisting
    return Joint(f.HOOKED, axis, motor, line, end.hook.bending, twisting)


def _members(case, scene, rows, turns):
    """Return the members by the name of what holds them, None for an end held in space.

    ``turns``: the rotation (3, 3) and the centre (3,) of each body.
    """
    from rodsim.blocks.table import Member

    found, rotor = [], scene.rods.points + len(scene.bodies)
    for name, which, end in held_ends(case):
        rod = rod_named(scene.rods, name)
        start = scene.arrays[name][f"held_{which}"]
        place, triad = start[:3], start[3:].reshape(3, 3)
        turn, centre = turns.get(end.to, (np.eye(3), place))
        local = triad @ turn
        joint = _joint(end, local)
        if end.motor is not None and end.motor.axis is not None:
            axis = np.asarray(end.motor.axis, dtype=float) @ turn
            joint = replace(joint, axis=axis / np.linalg.norm(axis))
        motor_row = 0
        if end.motor is not None:
            value = end.motor.torque if end.motor.rate is None else end.motor.rate
            motor_row = rows.add([value], True, (name, which, "motor"))
        mine = -1
        if winds_up(end):
            mine, rotor = rotor, rotor + 1
        node, label = end_node(rod, which), f"{name}.{which}"
        place = (place - centre) @ turn
        found.append((end, Member(label, node, place, local, joint, mine, motor_row)))
    return found


def _blocks(case, scene, rows):
    """Return the blocks of a scene: bodies, then each end held in space."""
    from rodsim.blocks.table import Block

    turns = {body.name: (body.turn, body.centre) for body in scene.bodies}
    members = _members(case, scene, rows, turns)
    blocks = []
    for body in scene.bodies:
        mine = tuple(member for end, member in members if end.to == body.name)
        motion, place = case.bodies[body.name].motion, -1
        if isinstance(motion, Motion):
            turn = motion.turn or (0.0, 0.0, 0.0)
            turn = turn, (motion.spin or _rates(turn))
            place = _given(rows, (0.0,) * 3, turn, (body.name,), motion.velocity)
        free = motion == "free"
        blocks.append(Block(body.name, body.node, mine, body.surface, free, place))
    for end, member in members:
        if end.to != HELD_IN:
            continue
        rod, which = member.name.rsplit(".", 1)
        place = -1
        if end.move is not None:
            turn = end.move.turn, _rates(end.move.turn)
            place = _given(rows, end.move.displace, turn, (rod, which))
        origin = scene.arrays[rod][f"held_{which}"][:3]
        blocks.append(Block(member.name, -1, (member,), motion=place, origin=origin))
    return blocks


def _build(case, scene) -> list[Part]:
    if not case.bodies and not any(getattr(rod, w) for rod in case.rods.values() for w in ENDS):
        return []
    from rodsim.blocks.report import Report
    from rodsim.blocks.statics import statics_of
    from rodsim.blocks.table import numbers_of

    rows = _Rows()
    blocks = _blocks(case, scene, rows)
    if not blocks:
        return []
    if case.bodies and case.fluid.flow is not None:
        from rodsim.flows.background import Background, Now

        flow = Background(case.fluid.flow)
        if flow.driven:
            rows.entries.append(Entry(Now(), AT, 0))
        fixed = numbers_of(blocks, scene, flow.numbers(scene.planar))
    else:
        fixed = numbers_of(blocks, scene)
    row = Row(rows.size, rows.entries, rows.watched)
    _check_finite(row, case)
    report = Report(blocks, scene)
    shared = {"row": row, "fixed": fixed, "drive": "a motion or a motor"}
    parts = [
        Part("held", PLACE, "rodsim.blocks.frames:place_members", **shared,
             statics=statics_of(blocks, scene, shared)),
        Part("held", RELEASE, "rodsim.blocks.hold:release", **shared),
        Part("held", HOLD, "rodsim.blocks.hold:hold", **shared, external=report.driven,
             sums=pair_sum(scene, "spatial") + pair_sum(scene, "flow"), gauges=report.gauges,
             report=report, series=report.series, labels=report.labels),
    ]  # fmt: skip
    if scene.bodies:
        parts.append(
            Part("held", TRACERS, "rodsim.blocks.hold:stir", **shared, pressure=report.pressure)
        )
    return [*parts, *_body_loads(case, scene)]


def _check_finite(row, case):
    values = row.at(case.time.end * LOOKED_AT)
    if not np.isfinite(values).all():
        t = case.time.end * LOOKED_AT[int(np.isfinite(values).all(axis=1).argmin())]
        reason = f"a given motion or a motor is not finite at t = {t:.4g}, or has no slope there"
        raise CaseError([case.source.problem(("rods",), reason)])


def _body_loads(case, scene) -> list[Part]:
    """Return the part of forces and torques on bodies, if there are any."""
    found = [
        (body.node, (*case.bodies[body.name].force, *case.bodies[body.name].torque))
        for body in scene.bodies
    ]
    if not any(value != 0.0 for _, values in found for value in values):
        return []
    count = len(found)
    entries = [
        Entry(value, AT, i * count + b, ("body", b))
        for b, (_, values) in enumerate(found)
        for i, value in enumerate(values)
    ]
    fixed = np.array([*(node for node, _ in found), *[1.0] * count, *[0.0] * count])
    row = Row(6 * count, entries)
    kernel = "rodsim.forces.loads:apply_loads"
    return [Part("body_loads", FORCE, kernel, row, fixed, drive="a load on a body", external=True)]


KIND = Kind(
    build=_build,
    word="bodies",
    where="Case",
    words=Annotated[dict[Name, Body], AfterValidator(not_empty)],
    about="rigid bodies, by name; rods can be attached to them",
    check=check,
)
START, END = (
    Kind(build=lambda case, scene: [], word=which, where="Rod", words=End, about=about)
    for which, about in (
        ("start", "how the first point is held"),
        ("end", "how the last point is held"),
    )
)
