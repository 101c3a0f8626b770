"""Orientations as the output has them: unit quaternions (w, x, y, z), w >= 0."""

import numpy as np


def to_quaternion(turn: np.ndarray) -> np.ndarray:
    """Return the quaternion (4,) of a rotation matrix (3, 3), from its largest component."""
    trace = np.trace(turn)
    squares = np.append(trace, 2.0 * np.diag(turn) - trace)  # 4 q^2 - 1
    k = int(np.argmax(squares))
    skew = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    products = np.empty((4, 4))  # 4 q_i q_j off the diagonal
    products[0, 1:] = products[1:, 0] = skew
    products[1:, 1:] = turn + turn.T
    products[k, k] = 1.0 + squares[k]
    q = products[k] / np.linalg.norm(products[k])
    return q if q[0] >= 0.0 else -q


def to_matrix(q: np.ndarray) -> np.ndarray:
    """Return the rotation matrix (3, 3) of a quaternion (4,) of any length but 0."""
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )
