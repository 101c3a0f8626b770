"""The constant matrices of a rigid block, in its own frame.

A block is points that move rigidly together: n of a surface, with forces, and m members, held
points of rods, with forces and torques. Its loads L on the fluid and its velocities are bound by

    A L + v = K V + k,    K^T L + D V = Q

A : mobility of the block with itself; v : velocities at its points by all else; V : velocity and
angular velocity, where they are free, then the free spins of its joints; K : what V moves; k : the
given part of the motion; Q : the loads that the block passes on; D : how fast the torque of a motor
falls with its rate. Between blobs of sizes a and b epsilon^2 = (a^2 + b^2)/2, which keeps A
symmetric and positive definite. With A^-1, N = K^T A^-1 K + D,

    V = N^-1 Q + G^T (v - k),    L = G Q - P (v - k)
    G = A^-1 K N^-1,             P = A^-1 - A^-1 K N^-1 K^T A^-1
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


def pair_epsilon(first: float, second: float) -> float:
    """Return the blob size between two blobs: the quadratic mean of theirs."""
    return float(np.sqrt(0.5 * (first * first + second * second)))


def self_mobility(blob: str, epsilon: float, viscosity: float) -> tuple[float, float]:
    """Return velocity per force and angular velocity per torque of a point on itself.

    H1 and D1/4 at r = 0: 1/(4 pi mu eps) and 5/(16 pi mu eps^3) for algebraic7.
    """
    translation, rotation = {"algebraic7": (2.0, 2.5), "algebraic9": (3.0, 6.25)}[blob]
    scale = 1.0 / (8.0 * np.pi * viscosity)
    return translation * scale / epsilon, rotation * scale / epsilon**3


def mobility(points, members, blob, epsilons, viscosity) -> np.ndarray:
    """Return A (3 n + 6 m, 3 n + 6 m) of surface points (3, n) and members (3, m).

    Order: the velocities of each surface point, then (u, w) of each member. ``epsilons``: of the
    surface, of the members.
    """
    groups = [(points, 3, epsilons[0]), (members, 6, epsilons[1])]
    rows = [_columns(groups, source, blob, viscosity) for source in groups]
    matrix = np.concatenate(rows).T
    return 0.5 * (matrix + matrix.T)


def _columns(groups, source, blob, viscosity):
    """Return the velocities (components, size of A) by a unit load in each component."""
    from rodsim.flows.blobs import BLOBS
    from rodsim.flows.by_threads import velocity_kernel

    points, components, epsilon = source
    columns = np.zeros((points.shape[1] * components, sum(g[0].shape[1] * g[1] for g in groups)))
    for k in range(points.shape[1]):
        place = np.ascontiguousarray(points[:, k : k + 1])
        for c in range(components):
            load, line, begin = np.zeros((6, 1)), columns[k * components + c], 0
            load[c] = 1.0
            for targets, size, own in groups:
                end = begin + targets.shape[1] * size
                if end > begin:
                    kernel = velocity_kernel(BLOBS[blob], angular=size == 6)
                    out = np.zeros((size, targets.shape[1]))
                    kernel(targets, place, load, pair_epsilon(epsilon, own), viscosity, 0.0, out)
                    line[begin:end] = out.T.ravel()
                begin = end
    return columns


def rigid_motion(points, members) -> np.ndarray:
    """Return the columns (3 n + 6 m, 6) of K for a velocity and an angular velocity about 0."""
    blocks = [np.hstack([np.eye(3), -cross_matrix(p)]) for p in points.T]
    for p in members.T:
        blocks += [np.hstack([np.eye(3), -cross_matrix(p)]), np.eye(6)[3:]]
    return np.concatenate(blocks) if blocks else np.zeros((0, 6))


def spins(n: int, m: int, axes) -> np.ndarray:
    """Return the columns of K for joints: axes, (member, direction (3,)) of each free spin."""
    columns = np.zeros((3 * n + 6 * m, len(axes)))
    for j, (member, axis) in enumerate(axes):
        begin = 3 * n + 6 * member + 3
        columns[begin : begin + 3, j] = axis
    return columns


def cross_matrix(p) -> np.ndarray:
    """Return [p] with [p] q = p x q."""
    return np.array([[0.0, -p[2], p[1]], [p[2], 0.0, -p[0]], [-p[1], p[0], 0.0]])


@dataclass(frozen=True)
class Factors:
    """P (d, d), G (d, c) and N^-1 (c, c) of a block."""

    P: np.ndarray
    G: np.ndarray
    inverse: np.ndarray


def factors(A: np.ndarray, K: np.ndarray, line: np.ndarray) -> Factors:
    """Return what solves a block; ``line`` (c,) is the diagonal of D."""
    inverse_A = np.linalg.inv(A)
    inverse_A = 0.5 * (inverse_A + inverse_A.T)
    AK = inverse_A @ K
    N = K.T @ AK + np.diag(line)
    inverse = np.linalg.inv(0.5 * (N + N.T)) if line.size else np.zeros((0, 0))
    G = AK @ inverse
    P = inverse_A - G @ AK.T
    return Factors(0.5 * (P + P.T), G, 0.5 * (inverse + inverse.T))


def resistance_of(points, blob, epsilon, viscosity) -> np.ndarray:
    """Return drag and torque (6, 6) of rigid motions of a surface, points (3, n): K^T A^-1 K."""
    none = np.zeros((3, 0))
    A = mobility(points, none, blob, (epsilon, epsilon), viscosity)
    K = rigid_motion(points, none)
    found = K.T @ np.linalg.solve(A, K)
    return 0.5 * (found + found.T)
