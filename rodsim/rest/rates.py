"""How fast perturbations of a state at rest grow and decay in the fluid: z' = -A K z.

A is the mobility: what loads on the nodes move. It is symmetric and positive definite, so with
A = l l^T the rates are the eigenvalues of -l^T K l, real, where K is the exact gradient's. Where
epsilon is so large that A has no such factor in rounding, or forces have no energy, they are those
of -A K itself. Waves shorter than epsilon hardly move: their slow rates mean nothing physical, so a
perturbation s is told by how its energy is shared among the rates.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rodsim.compiled.parts import FLOW, HOLD, RELEASE
from rodsim.scene.evaluation import Evaluation

MOST_POINTS = 400  # for dense matrices: a quarter of a minute

SAME_RATE = 1e-6  # relative


@dataclass(frozen=True)
class Rates:
    """Rates of all modes, fastest growing first, 1/time, complex where they turn.

    vectors (n, n) : of each, in columns of the free degrees of freedom, where A has a factor.
    """

    values: np.ndarray
    vectors: np.ndarray | None = None


def mobility(scene, state, free: np.ndarray) -> np.ndarray:
    """Return the velocities of the free degrees of freedom for unit loads, one in each column.

    What holds nodes takes its own loads, so that they stay or go where their bodies go. Hooks move
    the state as it is: that is taken off.
    """
    flows = Evaluation(scene, scene.parts.of(RELEASE, FLOW, HOLD))

    def velocity(*numbers):
        loads, found = np.zeros((6, scene.nodes)), np.zeros((6, scene.nodes))
        loads.flat[list(numbers)] = 1.0
        flows.add(state, loads, found, np.zeros_like(state.tracer))
        return found.ravel()[free]

    matrix, still = np.empty((len(free), len(free))), velocity()
    for column, number in enumerate(free):
        matrix[:, column] = velocity(number) - still
    return matrix


def rates_of(stiffness, moves: np.ndarray) -> Rates:
    """Return the rates of z' = -A K z; ``stiffness`` K sparse, ``moves`` A, both (n, n)."""
    from scipy.linalg import cholesky, eigh, eigvals

    moves = 0.5 * (moves + moves.T)
    uneven = abs(stiffness - stiffness.T).max() > 1e-7 * abs(stiffness).max()
    try:
        if uneven:
            raise np.linalg.LinAlgError
        factor = cholesky(moves, lower=True)
    except np.linalg.LinAlgError:
        values = eigvals(-(stiffness.T @ moves).T)
        return Rates(values[np.argsort(-values.real)])
    product = factor.T @ (stiffness @ factor)
    values, vectors = eigh(-0.5 * (product + product.T))
    return Rates(values[::-1], (factor @ vectors)[:, ::-1])


def shares_of(rates: Rates, stiffness, perturbation: np.ndarray) -> np.ndarray:
    """Return which share of the energy 1/2 s.K s of a perturbation decays at each rate.

    E_i = (v_i . K s)^2/(-r_i s . K s); they add up to 1. Modes whose rate is 0 have no share.
    """
    bent = stiffness @ perturbation
    along = (rates.vectors.T @ bent) ** 2
    shares = np.zeros_like(along)
    real = abs(rates.values) > 1e-9 * abs(rates.values).max()
    shares[real] = -along[real] / (rates.values[real] * (perturbation @ bent))
    return shares


def main_rates(rates: Rates, shares: np.ndarray, count: int) -> list[tuple[float, float]]:
    """Return the rates with the largest shares, and these; rates that are the same are one."""
    order = np.argsort(rates.values)
    values, shares = rates.values[order], shares[order]
    first = np.append(True, np.diff(values) > SAME_RATE * abs(values[1:]))
    sums = np.add.reduceat(shares, np.flatnonzero(first))
    largest = np.argsort(-abs(sums))[:count]
    return [(float(values[first][k]), float(sums[k])) for k in largest]
