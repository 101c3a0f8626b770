"""Arcs: the points of each rod halved again and again, and the proxies that stand for an arc.

An arc of m points has p = min(n, m) of its own points as proxies, close to Chebyshev's. Anything
that varies smoothly with the number k of a point is, on the arc, its interpolant in k through the
proxies, a polynomial of degree p - 1: value(k) = sum_j W_jk value(proxy j). Loads go the other way,
by the transpose. Arcs of equal numbers of points share W, and W of an arc that is halved leads from
its proxies to those of its halves: polynomials lose nothing on the way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LO, COUNT, RIGHT, START, PROXIES, WEIGHT = range(6)  # columns of ``nodes``
SHARES = 64  # work is cut into so many subtrees, at least, whatever the number of threads


@dataclass(frozen=True)
class Arcs:
    """The arcs of all rods, each before its halves and the left half before the right.

    nodes (K, 6) : first point, number of points, number of the right half (0: not halved; the left
    half comes next), first of its proxies, how many, where its weights begin.
    proxies (Q,) : their points. weights : all W, one after another, each (p, m) of an arc that is
    not halved, (p, p_left + p_right) else. roots (R,) : the arcs that are whole rods.
    chunks (C, 2) : first and last + 1 arc of subtrees that can be worked on at the same time;
    tops : the arcs above them.
    """

    points: int
    nodes: np.ndarray
    proxies: np.ndarray
    weights: np.ndarray
    roots: np.ndarray
    chunks: np.ndarray
    tops: np.ndarray

    @property
    def leaves(self) -> np.ndarray:
        """The arcs that are not halved."""
        return np.flatnonzero(self.nodes[:, RIGHT] == 0)


def build_arcs(counts, n: int) -> Arcs:
    """Return the arcs of rods of so many points each, with up to n proxies, halved above 2 n."""
    weights, trees = _Weights(n), {}
    nodes, proxies, chunks, tops, roots = [], [], [], [], []
    most = max(2 * n, -(-sum(counts) // SHARES))
    arcs = points = slots = 0
    for count in map(int, counts):
        if count not in trees:
            trees[count] = _tree(count, weights, most)
        table, own, parts, above = trees[count]
        shift = np.array([points, 0, 0, slots, 0, 0])
        nodes.append(table + shift)
        nodes[-1][:, RIGHT] += arcs * (table[:, RIGHT] > 0)
        proxies.append(own + points)
        chunks.append(parts + arcs)
        tops.append(above + arcs)
        roots.append(arcs)
        arcs, points, slots = arcs + len(table), points + count, slots + len(own)
    joined = [np.concatenate(each).astype(np.int32) for each in (nodes, proxies, chunks, tops)]
    nodes, proxies, chunks, tops = joined
    return Arcs(points, nodes, proxies, weights.table, np.array(roots, np.int32), chunks, tops)


def _tree(count, weights, most):
    """Return nodes, proxies, chunks and tops of one rod, numbered from 0."""
    nodes, proxies, chunks, tops = [], [], [], []
    waiting, inside = [(0, count, -1)], 0  # arcs to come, the last one first
    while waiting:
        lo, m, parent = waiting.pop()
        number, (own, begin) = len(nodes), weights.of(m)
        if parent >= 0:
            nodes[parent][RIGHT] = number
        nodes.append([lo, m, 0, len(proxies), len(own), begin])
        proxies += [lo + k for k in own]
        if number >= inside:  # above all chunks so far
            if m <= most:
                inside = number + weights.arcs(m)
                chunks.append((number, inside))
            else:
                tops.append(number)
        if halved := weights.halves(m):
            waiting += [(lo + halved[0], halved[1], number), (lo, halved[0], -1)]
    shaped = np.array(chunks, np.int64).reshape(-1, 2)
    return np.array(nodes), np.array(proxies), shaped, np.array(tops, np.int64)


class _Weights:
    """Proxies and weights by number of points."""

    def __init__(self, n):
        self.n, self._blocks, self._known, self._size = n, [], {}, 0

    @property
    def table(self):
        return np.concatenate(self._blocks)

    def halves(self, m):
        """Return how many points each half of an arc has, or () where it is not halved."""
        return () if m <= 2 * self.n else (m - m // 2, m // 2)

    def arcs(self, m):
        """Return how many arcs an arc is made of, with itself."""
        return 1 + sum(self.arcs(half) for half in self.halves(m))

    def of(self, m):
        """Return the proxies of an arc, and where its weights begin."""
        if m not in self._known:
            own = chebyshev_points(m, min(self.n, m))
            if halved := self.halves(m):
                left, right = (chebyshev_points(half, min(self.n, half)) for half in halved)
                block = lagrange(own, np.concatenate([left, halved[0] + right]))
            else:
                block = lagrange(own, np.arange(m))
            self._known[m] = own.tolist(), self._size
            self._blocks.append(block.ravel())
            self._size += block.size
        return self._known[m]


def chebyshev_points(m: int, p: int) -> np.ndarray:
    """Return p of the numbers 0 ... m - 1, as near to (m - 1)(1 - cos(pi j/(p - 1)))/2 as they can.

    Both ends are among them, none comes twice, and from the other end they are the same (for odd p
    but for the middle one).
    """
    if p == 1:
        return np.zeros(1, dtype=np.int64)
    angles = np.pi * np.arange(p) / (p - 1)
    chosen = np.rint(0.5 * (m - 1) * (1.0 - np.cos(angles))).astype(np.int64)
    half = p // 2
    chosen[:half] = np.maximum(chosen[:half], np.arange(half))
    chosen[p - half :] = m - 1 - chosen[:half][::-1]
    return chosen


def lagrange(nodes: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return W (p, m) with W_jk = prod_(i != j) (x_k - x_i)/(x_j - x_i): exact at the nodes."""
    weights = np.ones((len(nodes), len(at)))
    for j, node in enumerate(nodes):
        for other in np.delete(nodes, j):
            weights[j] *= (at - other) / (node - other)
    return weights
