"""Passive fluid markers of a scene."""

import numpy as np


def tube(group, position, director, closed):
    """Markers on a tube around a rod, (3, around * along).

    X(s) + radius (cos(a) D^1 + sin(a) D^2) at ``along`` equal steps of s over the rod and
    ``around`` equal angles a; between two points, position and directors are interpolated.
    """
    points = position.shape[1]
    if closed:
        at = np.arange(group.along) * points / group.along
    else:
        at = np.linspace(0.0, points - 1.0, group.along)
    left = np.minimum(at.astype(int), points - 1)
    right = (left + 1) % points if closed else np.minimum(left + 1, points - 1)
    part = at - left
    centre = (1.0 - part) * position[:, left] + part * position[:, right]
    first, second = (
        _unit((1.0 - part) * director[i][:, left] + part * director[i][:, right]) for i in (0, 1)
    )
    angle = 2.0 * np.pi * np.arange(group.around) / group.around
    offset = np.cos(angle) * first[:, :, None] + np.sin(angle) * second[:, :, None]
    return (centre[:, :, None] + group.radius * offset).reshape(3, -1)


def _unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=0)
