"""Modes of a state at rest: K v = lambda W v with the symmetric stiffness of the exact gradient.

The mobility that turns loads into motion is positive definite, so as many modes grow as K has
negative eigenvalues, whatever viscosity and epsilon (Sylvester). They are counted by the signs of a
factorisation K - s W = l d l^T, which is sparse: any number of points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

ZERO = 1e-5  # of a ds (2 pi/L)^4, the stiffness of the longest wave: below it a mode is neutral
ROUNDING = 200.0  # times the largest entry and the unit of rounding
FARTHER = 4.0


@dataclass(frozen=True)
class Modes:
    """The lowest modes of a state at rest.

    growing, neutral : how many eigenvalues are below, and within, ``zero`` of 0. values (k,) :
    the lowest, force/length. shapes (k, 6, N) : dX and dtheta, largest displacement or epsilon
    times rotation 1.
    """

    growing: int
    neutral: int
    zero: float
    values: np.ndarray
    shapes: np.ndarray


def modes_of(forces, state, scales, count: int) -> Modes:
    """Return how many modes grow, how many are neutral, and ``count`` of the lowest.

    At least those that grow are among them. ``forces`` must be exact gradients.
    """
    matrix, root = scaled_stiffness(forces, state, scales)
    zero = zero_of(forces.scene, matrix)
    growing = negative(matrix, -zero)
    neutral = negative(matrix, zero) - growing
    size = matrix.shape[0]
    values, vectors = _lowest(matrix, min(max(count, growing), size), zero, growing)
    shapes = np.zeros((len(values), 6 * forces.scene.nodes))
    shapes[:, forces.free] = (vectors / root[:, None]).T
    return Modes(growing, neutral, zero, values, _normed(shapes, scales))


def scaled_stiffness(forces, state, scales):
    """Return W^(-1/2) K W^(-1/2), symmetric, and the square roots of W."""
    from scipy.sparse import diags_array

    root = np.sqrt(scales.drag[forces.free])
    matrix = diags_array(1.0 / root) @ forces.stiffness(state) @ diags_array(1.0 / root)
    return (0.5 * (matrix + matrix.T)).tocsc(), root


def zero_of(scene, matrix) -> float:
    """Return the size below which an eigenvalue counts as zero."""
    rods = scene.rods
    wave = rods.moduli[:2].min(axis=0) * rods.spacing * (2.0 * np.pi / rods.lengths) ** 4
    return max(ZERO * float(wave.min()), ROUNDING * np.finfo(float).eps * float(abs(matrix).max()))


def negative(matrix, shift: float) -> int:
    """Return how many eigenvalues of a symmetric matrix are below a shift."""
    from scipy.sparse import eye_array
    from scipy.sparse.linalg import splu

    symmetric = {"SymmetricMode": True, "Equil": False}
    shifted = (matrix - shift * eye_array(matrix.shape[0])).tocsc()
    factors = splu(shifted, "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=symmetric)
    if (factors.perm_r != factors.perm_c).any():  # a pivot was exactly 0
        return negative(matrix, shift * (1.0 + 1e-3))
    return int((factors.U.diagonal() < 0.0).sum())


def _lowest(matrix, count, zero, growing):
    """Return the ``count`` lowest eigenvalues and their vectors, from a shift below all of them."""
    from scipy.linalg import eigh
    from scipy.sparse.linalg import eigsh

    if count >= matrix.shape[0] - 1 or matrix.shape[0] < 60:
        values, vectors = eigh(matrix.toarray())
        return values[:count], vectors[:, :count]
    shift = -1e3 * zero
    while growing and negative(matrix, shift):
        shift *= FARTHER
    start = np.random.default_rng(1).normal(size=matrix.shape[0])
    values, vectors = eigsh(matrix, k=count, sigma=shift, v0=start)
    order = np.argsort(values)
    return values[order], vectors[:, order]


def _normed(shapes, scales):
    """Return shapes (k, 6, N) whose largest displacement, or epsilon times rotation, is 1."""
    lengths = (shapes * np.sqrt(scales.drag)).reshape(len(shapes), 2, 3, -1)
    largest = np.sqrt((lengths**2).sum(axis=2)).max(axis=(1, 2))
    return shapes.reshape(len(shapes), 6, -1) / largest[:, None, None]
