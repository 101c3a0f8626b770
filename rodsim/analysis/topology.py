"""How closed rods wind: writhe of the centreline, twist of the triads, linking number.

For a closed rod Lk = Tw + Wr (Calugareanu 1959, White 1969, Fuller 1971). All three are exact for
the polygon through the points, so the identity holds to rounding and Lk is a whole number.
"""

import numpy as np

from rodsim.errors import UsageError


def writhe(position: np.ndarray, closed: bool = True) -> float:
    """Return the writhe of the centreline (M, 3), a pure number.

    Wr = 1/4 pi sum over all pairs of segments of the solid angle under which they are seen to
    cross: Gauss's double integral, done exactly for each pair of straight segments (Klenin &
    Langowski, Biopolymers 54 (2000) 307-317, method 1a). Negative for left-handed coils. Of an
    open rod it is the same sum over its M - 1 segments, no invariant. O(M^2) time and memory.
    """
    segments = _segments(position, closed)
    return float(_crossing_angles(*_pairs(*segments, *segments)).sum() / (4.0 * np.pi))


def linking_number(first: np.ndarray, second: np.ndarray) -> float:
    """Return the linking number of two closed curves (M, 3), (N, 3): a whole number to rounding.

    Gauss's integral, exact for polygons, as in :func:`writhe`. Of a closed rod's own link:
    ``linking_number(X, X + d * D1)`` with d small.
    """
    pairs = _pairs(*_segments(first, True), *_segments(second, True))
    return float(_crossing_angles(*pairs).sum() / (4.0 * np.pi))


def twist(position: np.ndarray, director: np.ndarray, closed: bool = True) -> float:
    """Return the turns of the triads (M, 3, 3) about the centreline (M, 3), a pure number.

    Tw = 1/2 pi sum_k of the angle from D^1_k, carried to the next point without turning about the
    tangent (parallel transport over the segment between), to D^1_(k+1), all across the tangents
    of the polygon. Unlike :func:`rodsim.analysis.helix.triad_turns` it does not rest on D^3, so
    Tw + Wr is the linking number. ``director[k, 0]`` is D^1.
    """
    begin, end = _segments(position, closed)
    edge = _unit(end - begin)
    tangent = _tangents(edge, closed)
    across = director[:, 0] - np.einsum("kc,kc->k", director[:, 0], tangent)[:, None] * tangent
    across = _unit(across)
    after = np.roll(tangent, -1, axis=0)[: len(edge)]
    target = np.roll(across, -1, axis=0)[: len(edge)]
    carried = _transport(tangent[: len(edge)], edge, across[: len(edge)])
    carried = _transport(edge, after, carried)
    sine = np.einsum("kc,kc->k", np.cross(carried, target), after)
    cosine = np.einsum("kc,kc->k", carried, target)
    return float(np.arctan2(sine, cosine).sum() / (2.0 * np.pi))


def link(position: np.ndarray, director: np.ndarray) -> float:
    """Return Lk = Tw + Wr of a closed rod, position (M, 3), director (M, 3, 3).

    A whole number to rounding, where no more than that is lost in the sums. It changes only where
    the rod passes through itself, or where its triads turn half-way round between two points.
    """
    begin, end = _segments(position, True)
    i, j = np.triu_indices(len(begin), 1)  # each pair once: the other way round it has the same
    angle = _crossing_angles(begin[i], end[i], begin[j], end[j])
    return twist(position, director) + float(angle.sum() / (2.0 * np.pi))


def _segments(position, closed):
    position = np.asarray(position, float)
    if position.ndim != 2 or position.shape[1] != 3 or len(position) < 3:
        raise UsageError(f"a curve needs positions (M, 3), M >= 3, not {position.shape}")
    after = np.roll(position, -1, axis=0)
    return (position, after) if closed else (position[:-1], after[:-1])


def _tangents(edge, closed):
    """Return the tangents of the polygon at its points: half-way between the edges that meet."""
    if closed:
        return _unit(edge + np.roll(edge, 1, axis=0))
    inner = _unit(edge[1:] + edge[:-1])
    return np.concatenate([edge[:1], inner, edge[-1:]])


def _transport(before, after, vectors):
    """Turn vectors by the smallest rotation that takes one unit tangent to another."""
    axis = np.cross(before, after)
    cosine = np.einsum("kc,kc->k", before, after)[:, None]
    along = np.einsum("kc,kc->k", axis, vectors)[:, None]
    return cosine * vectors + np.cross(axis, vectors) + axis * along / (1.0 + cosine)


def _pairs(begin, end, other_begin, other_end):
    """Return segments (M, 3) and others (N, 3) so that all pairs of them are taken, (M, N)."""
    return begin[:, None], end[:, None], other_begin[None], other_end[None]


def _crossing_angles(begin, end, other_begin, other_end):
    """Return the signed solid angles of pairs of segments (..., 3); 0 where they share a point.

    The directions from one segment to the other fill a quadrangle on the sphere, which is cut
    into two triangles: tan(angle/2) = -a.(b x c)/(1 + a.b + b.c + c.a) for unit vectors (van
    Oosterom & Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125-126).
    """
    r13, r14 = other_begin - begin, other_end - begin
    r23, r24 = other_begin - end, other_end - end
    apart = np.logical_and.reduce([side.any(axis=-1) for side in (r13, r14, r23, r24)])
    r13, r14, r23, r24 = (_unit(side) for side in (r13, r14, r23, r24))
    return np.where(apart, _triangle(r13, r14, r24) + _triangle(r24, r23, r13), 0.0)


def _triangle(a, b, c):
    volume = np.einsum("...c,...c->...", a, np.cross(b, c))
    pairs = (np.einsum("...c,...c->...", u, v) for u, v in ((a, b), (b, c), (c, a)))
    return -2.0 * np.arctan2(volume, 1.0 + sum(pairs))


def _unit(vectors):
    """Return unit vectors; 0 for 0, as neighbouring segments have it."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0.0)
