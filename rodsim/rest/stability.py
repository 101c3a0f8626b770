"""Whether a state at rest is stable: its growing and neutral modes, their shapes and rates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rodsim.errors import UsageError
from rodsim.rest.descent import GREATEST, SAME, Descent, Scales, descend
from rodsim.rest.forces import Forces
from rodsim.rest.modes import Modes, modes_of
from rodsim.rest.output import NUMBER, STIFFNESS, UNKNOWN, write_states
from rodsim.rest.rates import MOST_POINTS, Rates, mobility, rates_of, shares_of
from rodsim.rest.solve import STEPS, refused_by, scales_of
from rodsim.rest.start import Start
from rodsim.scene.state import State

AT_REST = 10.0  # times the tolerance
SHOWN_MOVE, SHOWN_TURN = 0.05, 0.5  # of the longest rod; rad: of a mode that is drawn


@dataclass(frozen=True)
class Stability:
    """What is known of a state at rest.

    state : that of the exact gradient, O(ds^2) from what was given. modes : None where forces have
    no energy. rates : None where they were not asked for. shares (k, n) : of the energy of each
    mode that is not neutral, where rates have vectors.
    """

    start: Start
    state: State
    residual: float
    modes: Modes | None
    rates: Rates | None = None
    shares: np.ndarray | None = None


def stability_of(start: Start, count: int, with_rates: bool) -> Stability:
    """Return what is known of the initial state of a scene; UsageError where it is not at rest.

    count : how many of the lowest modes that are not neutral are wanted, those that grow first.
    """
    scene = start.scene
    if reason := refused_by(scene):
        raise UsageError(reason)
    scales, exact = scales_of(scene, start.case.rest), Forces(scene)
    residual = _at_rest(scene, scales)
    if with_rates:
        _not_too_many(scene.rods.points)
    # The symmetric stiffness is that of the gradient's own state, a Newton step or two away.
    newton = Descent(scene.initial, np.inf, GREATEST * scales.first)
    near = descend(exact, newton, scales, STEPS, SAME, lambda *_: None)
    if near.failure or not exact.conservative_at(near.state):
        paper = Forces(scene, exact=False)
        rates = _rates(paper, scene.initial) if with_rates else None
        return Stability(start, scene.initial, residual, None, rates)
    state = near.state
    modes = modes_of(exact, state, scales, count)
    if modes.neutral:
        modes = _without_neutral(modes_of(exact, state, scales, count + modes.neutral))
    # Rates take the mobility as well, and dense matrices.
    if not with_rates:
        return Stability(start, state, residual, modes)
    rates, stiffness = _rates(exact, state), exact.stiffness(state)
    flat = modes.shapes.reshape(len(modes.shapes), -1)[:, exact.free]
    shares = None
    if rates.vectors is not None:
        shares = np.array([shares_of(rates, stiffness, shape) for shape in flat])
    return Stability(start, state, residual, modes, rates, shares)


def _not_too_many(points: int) -> None:
    """Raise UsageError where dense matrices would take minutes."""
    if points > MOST_POINTS:
        raise UsageError(
            f"--rates: dense matrices for up to {MOST_POINTS} points, here are {points}: "
            "the number of growing modes needs none; for rates use fewer points"
        )


def _at_rest(scene, scales: Scales) -> float:
    """Return the residual of the loads that runs have; raise UsageError where it is too large."""
    forces = Forces(scene, exact=False)
    loads = np.zeros(6 * scene.nodes)
    loads[forces.free] = forces.loads(scene.initial).ravel()[forces.free]
    residual = scales.residual(loads.reshape(6, -1))
    if not residual <= AT_REST * scales.tolerance:
        raise UsageError(
            f"not at rest: residual {residual:.3g}, tolerance {scales.tolerance:.2g}; "
            "first find the state at rest: rodsim rest"
        )
    return residual


def _rates(forces, state):
    free = forces.free
    return rates_of(forces.stiffness(state), mobility(forces.scene, state, free))


def _without_neutral(modes):
    """Return the modes without those that cost nothing."""
    kept = abs(modes.values) > modes.zero
    counts = modes.growing, modes.neutral, modes.zero
    return Modes(*counts, modes.values[kept], modes.shapes[kept])


def write_modes(found: Stability, output, overwrite=False):
    """Write the state, then the state moved along each mode, as frames at times 0, 1, 2, ...

    Returns where an older output has gone, or None.
    """
    modes, length = found.modes, found.start.scene.length_scale
    states, values, forces = [found.state], [0.0], Forces(found.start.scene)
    for shape, value in zip(modes.shapes, modes.values, strict=True):
        move, turn = (np.sqrt((part**2).sum(axis=0)).max() for part in (shape[:3], shape[3:]))
        size = 1.0 / max(move / (SHOWN_MOVE * length), turn / SHOWN_TURN)
        states.append(forces.moved(found.state, size * shape))
        values.append(float(value))
    frames = len(states)
    series = {
        "residual": (NUMBER, [found.residual] + [UNKNOWN] * (frames - 1)),
        "mode_stiffness": (STIFFNESS, values),
        "growing_modes": (NUMBER, [float(modes.growing)] * frames),
        "neutral_modes": (NUMBER, [float(modes.neutral)] * frames),
    }
    return write_states(output, found.start, states, np.arange(frames), series, "finished", {},
                        overwrite, lambda text: None)  # fmt: skip
