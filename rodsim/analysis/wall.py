"""The piece of a plane wall that is shown with what lies above it."""

from __future__ import annotations

import numpy as np

AROUND = 0.1  # of the extent of what is shown: how far the piece reaches beyond it


def piece_of_wall(points: np.ndarray, height: float | None, reach=1.0) -> np.ndarray | None:
    """Return the corners (4, 3) of a piece of the wall z = ``height`` under points (n, 3).

    None where there is no wall, or where it is farther below than ``reach`` times what the points
    extend: they would be hard to see in a picture of both.
    """
    if height is None:
        return None
    low, high = points.min(axis=0), points.max(axis=0)
    extent = (high - low).max()
    if low[2] - height > reach * extent:
        return None
    (left, near, _), (right, far, _) = low - AROUND * extent, high + AROUND * extent
    corners = [[left, near], [right, near], [right, far], [left, far]]
    return np.column_stack([corners, np.full(4, height)])
