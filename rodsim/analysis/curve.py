"""Geometry of a centreline, and how well a rod keeps to its constraints."""

import numpy as np


def curvature(position: np.ndarray, closed: bool = False) -> np.ndarray:
    """Return the curvature, 1/length, at the points of a curve (M, 3): (M,), or (M - 2,) if open.

    That of the circle through a point and its two neighbours (Menger): 2 |a x b|/(|a||b||a + b|)
    with the edges a, b that meet there. Exact on circles, order 2 elsewhere.
    """
    before, after = _edges_at_points(position, closed)
    area = np.linalg.norm(np.cross(before, after), axis=1)
    lengths = [np.linalg.norm(edge, axis=1) for edge in (before, after, before + after)]
    return 2.0 * area / np.prod(lengths, axis=0)


def torsion(position: np.ndarray, closed: bool = False) -> np.ndarray:
    """Return the torsion, 1/length, of the edges of a curve (M, 3): (M,), or (M - 3,) if open.

    The angle between the planes of the points on both sides of an edge, over its length; positive
    for right-handed helices, order 2. Entry k belongs to the edge from point k (closed) or k + 1
    (open) to the next one. Without meaning where the curve is straight.
    """
    before, after = _edges_at_points(position, closed)
    normal = np.cross(before, after)
    if closed:
        first, second, edge = normal, np.roll(normal, -1, axis=0), after
    else:
        first, second, edge = normal[:-1], normal[1:], after[:-1]
    length = np.linalg.norm(edge, axis=1)
    sine = np.einsum("kc,kc->k", np.cross(first, second), edge) / length
    return np.arctan2(sine, np.einsum("kc,kc->k", first, second)) / length


def length(position: np.ndarray, closed: bool = False) -> float:
    """Return the length of the polygon through points (M, 3): sum |X_(k+1) - X_k|."""
    return float(np.linalg.norm(_edges(position, closed), axis=1).sum())


def end_to_end(position: np.ndarray) -> float:
    """Return |X_M - X_1|, length, the distance of the ends of an open rod (M, 3)."""
    return float(np.linalg.norm(position[-1] - position[0]))


def amplitude(position: np.ndarray) -> float:
    """Return the amplitude of a rod (M, 3) about its long axis, length.

    sqrt(2) times the root mean square of its points along the second of their principal axes: of
    a wave of many periods its amplitude, of a helix its radius, of a ring too, 0 of a straight rod.
    Of few periods of sin(k z) it is too small, by 2 % at four: the long axis turns towards them.
    """
    centred = position - position.mean(axis=0)
    spread = np.linalg.svd(centred, compute_uv=False)
    return float(np.sqrt(2.0 / len(position)) * spread[1])


def radius_of_gyration(position: np.ndarray) -> float:
    """Return sqrt(mean |X - mean X|^2), length, of points (M, 3)."""
    return float(np.sqrt(np.mean(np.sum((position - position.mean(axis=0)) ** 2, axis=1))))


def stretch(position: np.ndarray, spacing: float, closed: bool = False) -> np.ndarray:
    """Return |dX/ds| - 1 of every segment of a rod (M, 3), eq. (2): 0 if it is inextensible."""
    edge = _edges(position, closed)
    return np.linalg.norm(edge, axis=1) / spacing - 1.0


def misalignment(position: np.ndarray, director: np.ndarray, closed: bool = False) -> np.ndarray:
    """Return the angle, rad, between D^3 and the tangent of every segment, eq. (1).

    D^3 of a segment is half-way between those of its points; ``director[k, 2]`` is D^3.
    """
    edge = _edges(position, closed)
    third = director[:, 2]
    middle = (third + np.roll(third, -1, axis=0))[: len(edge)]
    across = np.linalg.norm(np.cross(middle, edge), axis=1)
    return np.arctan2(across, np.einsum("kc,kc->k", middle, edge))


def _edges(position, closed):
    edge = np.roll(position, -1, axis=0) - position
    return edge if closed else edge[:-1]


def _edges_at_points(position, closed):
    """Return the edges before and after each point that has both."""
    edge = _edges(position, closed)
    return (np.roll(edge, 1, axis=0), edge) if closed else (edge[:-1], edge[1:])
