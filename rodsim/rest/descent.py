"""Down to a state at rest: pseudo-transient continuation, which becomes Newton's method.

    (W/tau + K) dz = L(z),    z <- (X + dX, exp(dtheta x) D),    K = -dL/dz

with W = 1 for positions, epsilon^2 for rotation vectors: implicit Euler steps of the same rod with
local drag. Small tau follows the gradient, and cannot jump over a ridge; as tau grows it is Newton.
A step is taken where nothing moves too far and the energy, less the work of loads, does not rise.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np

from rodsim.rest.forces import Forces
from rodsim.scene.state import State

TURN = 0.3  # rad, the largest rotation of a triad in one step
SMALLEST = 1e-12  # of the first tau: below it nothing can be done
GREATEST = 1e12  # and above it, a step is Newton's to rounding
SAME = 1e-12  # of the energies: what rounding may add


@dataclass(frozen=True)
class Scales:
    """What is small: the units of force and torque, and the bounds of a step.

    force, torque : a/L^2 and a/L, a the largest bending modulus, L the longest rod. drag (6 N,) : W
    of each degree of freedom. move : the farthest a point may go in one step. first : the first
    tau. tolerance : of the residual.
    """

    force: float
    torque: float
    drag: np.ndarray
    move: float
    first: float
    tolerance: float

    def residual(self, loads: np.ndarray) -> float:
        """Return max |g|/(a/L^2) + max |m|/(a/L) of loads (6, N)."""
        force, torque = abs(loads[:3]).max(), abs(loads[3:]).max()
        return float(force / self.force + torque / self.torque)


@dataclass(frozen=True)
class Descent:
    """Where a descent has come to. ``failure`` : why it is not at rest, or nothing."""

    state: State
    residual: float
    tau: float
    steps: int = 0
    rejected: int = 0
    failure: str = ""


def descend(forces: Forces, start: Descent, scales: Scales, most: int, slack: float, tell):
    """Return the :class:`Descent` from where another one has come to.

    most : how many steps are taken in all. slack : by which share of its scale the energy may rise
    in a step. tell : called with (residual, steps) at each.
    """
    now, loads = start, _free(forces, forces.loads(start.state))
    now = replace(now, residual=scales.residual(loads), failure="")
    energy = forces.energy(now.state)
    rise = slack * max(abs(energy), scales.torque)
    while not now.residual < scales.tolerance:
        tell(now.residual, now.steps)
        if now.steps >= most:
            return replace(now, failure=f"not at rest after {now.steps} steps (rest.steps)")
        system = forces.stiffness(now.state)
        tau, rejected, found = now.tau, now.rejected, None
        while found is None:
            if tau < SMALLEST * scales.first:
                reason = "no step can be made that lowers the energy"
                return replace(now, tau=tau, rejected=rejected, failure=reason)
            found, tau = _try(forces, now.state, loads, energy + rise, system, tau, scales)
            rejected += found is None
        state, energy, loads = found
        now = Descent(state, scales.residual(loads), tau, now.steps + 1, rejected)
    return now


def _try(forces, state, loads, most, system, tau, scales):
    """Return (state, energy, loads) after a step, or None, and the tau to go on with."""
    change = np.zeros(loads.size)
    change[forces.free] = _solved(
        system, scales.drag[forces.free] / tau, loads.ravel()[forces.free]
    )
    change = change.reshape(loads.shape)
    used = _used(change, scales)
    if not used <= 1.0:
        return None, tau * min(0.7, max(0.1, 0.7 / used)) if used < np.inf else 0.1 * tau
    after = forces.moved(state, change)
    energy, new = forces.energy(after), _free(forces, forces.loads(after))
    if not (energy - forces.work(state, after, change) <= most and np.isfinite(new).all()):
        return None, 0.3 * tau
    if used < 0.6:
        tau = min(tau * min(3.0, max(1.1, 0.7 / max(used, 0.1))), GREATEST * scales.first)
    return (after, energy, new), tau


def _solved(system, shift, loads):
    """Return the solution of (W/tau + K) dz = L, not finite where that is singular."""
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import splu

    matrix = (system + diags_array(shift)).tocsc()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return splu(matrix, "MMD_AT_PLUS_A", diag_pivot_thresh=0.01).solve(loads)
    except RuntimeError:  # exactly singular
        return np.full_like(loads, np.inf)


def _used(change, scales):
    """Return which share of what may be moved in one step a change moves."""
    with np.errstate(over="ignore", invalid="ignore"):
        move = np.sqrt((change[:3] ** 2).sum(axis=0)).max() / scales.move
        turn = np.sqrt((change[3:] ** 2).sum(axis=0)).max() / TURN
    used = float(max(move, turn))
    return used if np.isfinite(used) else np.inf


def _free(forces, loads):
    """Return loads with zeros where something holds the nodes."""
    kept = np.zeros(loads.size)
    kept[forces.free] = loads.ravel()[forces.free]
    return kept.reshape(loads.shape)
