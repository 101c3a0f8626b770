"""Points at equal steps of arc length along a curve."""

import numpy as np


def equal_arcs(speed, edges, target, scale=None):
    """Return the parameters at which the arc length from edges[0] on is ``target`` (M,).

    ``speed``: |dX/du|, of arrays; ``edges``: cells of u in which it is smooth. Gauss-Legendre
    quadrature of the arc length over the cells, then Newton's method inside the cell of each point,
    until the changes are 1e-15 of ``scale``, by default the whole range of u.
    """
    arc = quadrature(speed)
    total = np.concatenate([[0.0], np.cumsum(arc(edges[:-1], edges[1:]))])
    left = np.clip(np.searchsorted(total, target, side="right") - 1, 0, len(edges) - 2)
    u = edges[left] + (target - total[left]) / speed(edges[left])
    limit = 1e-15 * (edges[-1] - edges[0] if scale is None else scale)
    for _ in range(60):
        change = (total[left] + arc(edges[left], u) - target) / speed(u)
        u = np.clip(u - change, edges[left], edges[left + 1])
        if np.max(np.abs(change)) < limit:
            break
    return u


def arc_length(speed, edges) -> float:
    """Return the arc length over all cells."""
    return float(np.sum(quadrature(speed)(edges[:-1], edges[1:])))


def quadrature(speed):
    """Return arc(a, b), the arc length from a to b (n,) by twelve points: exact to rounding in
    cells where the speed is smooth.
    """
    node, weight = np.polynomial.legendre.leggauss(12)

    def arc(a, b):
        middle, half = 0.5 * (a + b)[:, None], 0.5 * (b - a)[:, None]
        return np.sum(weight * half * speed(middle + half * node), axis=1)

    return arc
