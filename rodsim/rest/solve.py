"""From any state of a scene to a state at rest, and away from saddles."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rodsim.rest.descent import GREATEST, SAME, TURN, Descent, Scales, descend
from rodsim.rest.forces import Forces
from rodsim.rest.modes import modes_of
from rodsim.scene.state import State

FIRST = 1e-3  # tau, in ds/b
PATH = 0.02  # of the longest rod: how far a point may go in a step
TOLERANCE, STEPS, SADDLES = 1e-9, 2000, 20
PUSH, SLOW = 0.1, 0.3  # of the bounds of a step; and of 1/|lambda|, where a step still grows
PAPER = 1e-6  # by which share the energy may rise: the paper's loads are not quite its gradient
COUNTED = 6  # modes


@dataclass(frozen=True)
class Rest:
    """A state at rest, or as near as it came; ``failure`` says why it is not one.

    growing, neutral : modes, None where forces have no energy. saddles : how many were left.
    """

    state: State
    residual: float
    tolerance: float
    steps: int
    rejected: int
    growing: int | None = None
    neutral: int | None = None
    saddles: int = 0
    failure: str = ""


def scales_of(scene, settings=None) -> Scales:
    """Return the scales of a scene; ``settings``: the section ``rest`` of its case, or None."""
    rods = scene.rods
    bending, length = float(rods.moduli[:2].max()), scene.length_scale
    stiffest, ds = float(rods.moduli[3:].max()), float(rods.spacing.min())
    drag = np.ones((6, scene.nodes))
    drag[3:] = scene.epsilon**2
    for body in scene.bodies:
        drag[3:, body.node] = (body.surface.skin**2).sum(axis=0).max()
    move = min([PATH * length, *(part.statics.move for part in scene.parts)])
    rounding = 20.0 * 1.1e-16 * (stiffest * length**2 / bending) * (length / ds)
    return Scales(
        force=bending / length**2,
        torque=bending / length,
        drag=drag.ravel(),
        move=settings.max_step if settings and settings.max_step else move,
        first=FIRST * ds / stiffest,
        tolerance=max(settings.tolerance if settings else TOLERANCE, rounding),
    )


def find_rest(
    scene, settings=None, saddle: bool = False, tell=lambda residual, steps: None
) -> Rest:
    """Return the state at rest that the initial state of a scene descends to.

    settings : the section ``rest`` of the case, or None. saddle : stay at a state at rest that is
    not stable; otherwise it is left along its fastest growing mode, in the direction in which the
    energy falls. tell : called with (residual, steps) at each step.

    It descends with the exact gradient of the energy, and ends with a few steps of the loads that
    runs have, whose state at rest is O(ds^2) away.
    """
    scales, exact = scales_of(scene, settings), Forces(scene)
    most = settings.steps if settings else STEPS
    if reason := _never(exact, scene.initial, scales):
        residual = scales.residual(exact.loads(scene.initial))
        return Rest(scene.initial, residual, scales.tolerance, 0, 0, failure=reason)
    now, modes, left = _settled(exact, scales, most, 0 if saddle else SADDLES, tell)
    if not now.failure:
        slack = PAPER
        if modes and modes.growing:  # only Newton's method leads from a saddle to the one beside it
            now, slack = replace(now, tau=GREATEST * scales.first), np.inf
        now = descend(Forces(scene, exact=False), now, scales, most, slack, tell)
    failure = now.failure and f"{now.failure}; residual {now.residual:.3g}"
    if not failure and now.state.position[2].min() < scene.floor:
        failure = "the shape at rest goes through the wall, which holds nothing without contact"
    counts = (modes.growing, modes.neutral) if modes else (None, None)
    cost = now.steps, now.rejected
    return Rest(now.state, now.residual, scales.tolerance, *cost, *counts, left, failure)


def _settled(exact, scales, most, saddles, tell):
    """Return the end of a descent, its modes or None, and how many saddles were left on the way."""
    now, left = Descent(exact.scene.initial, np.inf, scales.first), 0
    while True:
        now = descend(exact, now, scales, most, SAME, tell)
        if now.failure or not exact.conservative_at(now.state):
            return now, None, left
        modes = modes_of(exact, now.state, scales, COUNTED)
        if not modes.growing or left == saddles:
            return now, modes, left
        now, left = _pushed(exact, now, modes, scales), left + 1


def refused_by(scene) -> str:
    """Return why states at rest cannot be looked for in a scene, or nothing."""
    return next((part.statics.refused for part in scene.parts if part.statics.refused), "")


def _never(forces, state, scales):
    """Return why nothing can come to rest, or nothing: forces on what is free to move on."""
    n = forces.scene.nodes
    if refused := refused_by(forces.scene):
        return refused
    stiffness, every = forces.stiffness(state), np.zeros((6 * n, 3))
    for axis in range(3):
        every[axis * n : (axis + 1) * n, axis] = 1.0
    every = every[forces.free]
    total = every.T @ forces.loads(state).ravel()[forces.free]
    held = abs(stiffness @ every).max(axis=0) > 1e-9 * abs(stiffness).max()
    pushed = abs(total) > n * scales.tolerance * scales.force
    if not (pushed & ~held).any():
        return ""
    shown = ", ".join(f"{force:.3g}" for force in total)
    return f"nothing holds the scene against its net force ({shown}): it would move on for ever"


def _pushed(forces, now, modes, scales):
    """Return the state moved along its fastest growing mode, to the side of lower energy."""
    shape = modes.shapes[0]
    move = np.sqrt((shape[:3] ** 2).sum(axis=0)).max() / scales.move
    turn = np.sqrt((shape[3:] ** 2).sum(axis=0)).max() / TURN
    shape = PUSH / max(move, turn) * shape
    sides = [forces.moved(now.state, side * shape) for side in (1.0, -1.0)]
    state = min(sides, key=forces.energy)
    return replace(now, state=state, tau=SLOW / abs(modes.values[0]))
