"""Arcs and their lists: polynomials pass unharmed, every pair of points counts once, real gaps."""

import numpy as np
import pytest
from curves import suspension

from rodsim.flows.fast.arcs import COUNT, LO, PROXIES, START, build_arcs, chebyshev_points, lagrange
from rodsim.flows.fast.groups import MOST, grouped, lists_of_groups
from rodsim.flows.fast.lists import pairs_of_arcs
from rodsim.flows.fast.passes import down, up
from rodsim.flows.fast.plan import FastSum

COUNTS = (1, 3, 211, 17, 480, 2, 64)
THETA, SMOOTH = 0.53, 1.3e-4


@pytest.fixture(scope="module")
def fast():
    return FastSum(COUNTS, 1e-5, 0.4, 0.7)


@pytest.fixture(scope="module")
def points():
    return np.ascontiguousarray(suspension(COUNTS).T)


def tree_of(arcs):
    return arcs.nodes, arcs.proxies, arcs.weights, arcs.chunks, arcs.tops


@pytest.mark.parametrize("p", [2, 4, 6, 8, 12, 18])
def test_proxies_are_distinct_and_the_same_from_both_ends(p):
    for m in range(p, 9 * p):
        chosen = chebyshev_points(m, p)
        assert (np.diff(chosen) > 0).all()
        assert chosen[0] == 0
        assert chosen[-1] == m - 1
        assert np.array_equal(m - 1 - chosen[::-1], chosen)


def test_interpolation_is_stable_and_exact_for_polynomials():
    for m in range(9, 300, 7):
        own = chebyshev_points(m, 8)
        weights = lagrange(own, np.arange(m))
        assert abs(weights).sum(axis=0).max() <= 4.0 + 1e-9  # Chebyshev's own points: 2.1
        x = np.arange(m) / m - 0.4
        for power in range(8):
            # Rounding of 8 terms of size up to 4 times 0.6^power.
            assert weights.T @ x[own] ** power == pytest.approx(x**power, abs=1e-14)


def test_moments_of_loads_arrive_at_the_proxies(fast, points):
    """sum_k g_k k^q of an arc is that of its proxies, q < n: so the way up is the transpose."""
    arcs, loads = fast.arcs, np.random.default_rng(2).normal(size=(6, points.shape[1]))
    places, shares, _ = up(*tree_of(arcs), points, loads)
    for node in arcs.nodes:
        own = slice(node[START], node[START] + node[PROXIES])
        slots, k = arcs.proxies[own], np.arange(node[LO], node[LO] + node[COUNT])
        assert np.array_equal(places[:, own], points[:, slots])
        for q in range(node[PROXIES]):
            scale = (k - k[0]) / node[COUNT]
            expected = loads[:, k] @ scale**q
            found = shares[:, own] @ ((slots - k[0]) / node[COUNT]) ** q
            assert found == pytest.approx(expected, abs=1e-12 * len(k))


def test_the_way_down_is_the_transpose_of_the_way_up(fast, points):
    """<v, up g> = <down v, g> with proxies of all arcs: the mobility is symmetric if K is."""
    arcs, rng = fast.arcs, np.random.default_rng(4)
    loads = rng.normal(size=(6, points.shape[1]))
    _, shares, zeros = up(*tree_of(arcs), points, loads)
    v = rng.normal(size=zeros.shape)
    out, scale = np.zeros_like(loads), 0.37
    down(*tree_of(arcs), scale, v.copy(), out)
    left, right = (v * shares).sum(), (out * loads).sum() / scale
    assert right == pytest.approx(left, rel=1e-12, abs=1e-10)


def test_chunks_and_tops_are_all_arcs_once(fast):
    for arcs in (fast.arcs, build_arcs([3000], 6), build_arcs([9] * 200, 8)):
        seen = [np.arange(begin, end) for begin, end in arcs.chunks]
        assert np.array_equal(np.sort(np.concatenate([*seen, arcs.tops])), range(len(arcs.nodes)))


def test_every_pair_of_points_is_in_one_pair_of_arcs(fast, points):
    arcs, n = fast.arcs, points.shape[1]
    seen = np.zeros((n, n), dtype=int)
    bounds = fast.bounds(points)
    lists = pairs_of_arcs(points, arcs.nodes, bounds, arcs.roots, THETA, SMOOTH)
    assert min(map(len, lists)) > 10
    for pairs in lists:
        for pair in pairs:
            i, j = (slice(arcs.nodes[a][LO], sum(arcs.nodes[a][:2])) for a in pair)
            seen[i, j] += 1
            if pair[0] != pair[1]:
                seen[j, i] += 1
    assert (seen == 1).all()


def test_far_arcs_are_apart_by_what_lies_between_their_points(fast, points):
    """The gap is never more than the smallest distance, so half a length is theta of that."""
    arcs, bounds = fast.arcs, fast.bounds(points)
    far, _ = pairs_of_arcs(points, arcs.nodes, bounds, arcs.roots, THETA, SMOOTH)
    for pair in far:
        x, y = (points[:, arcs.nodes[a][LO] : sum(arcs.nodes[a][:2])] for a in pair)
        nearest = np.linalg.norm(x[:, :, None] - y[:, None], axis=0).min()
        length = max(np.linalg.norm(np.diff(z, axis=1), axis=0).sum() for z in (x, y))
        assert THETA * nearest >= 0.5 * length * (1.0 - 1e-12)


def test_every_target_meets_every_point_once(fast, points):
    targets = np.random.default_rng(8).uniform(-20.0, 20.0, (3, 331))
    order, begins = grouped(targets)
    assert np.array_equal(np.sort(order), range(331))
    assert np.diff(begins).max() <= MOST
    arcs, bounds = fast.arcs, fast.bounds(points)
    lists = lists_of_groups(
        points, targets, order, begins, arcs.nodes, bounds, arcs.roots, THETA, SMOOTH
    )
    for g in range(len(begins) - 1):
        seen = np.zeros(points.shape[1], dtype=int)
        for ends, members in (lists[:2], lists[2:]):
            for a in members[ends[g] : ends[g + 1]]:
                seen[arcs.nodes[a][LO] : sum(arcs.nodes[a][:2])] += 1
        assert (seen == 1).all()
