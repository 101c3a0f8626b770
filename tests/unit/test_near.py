"""Points near to each other, by blocks, by cells and sorted, against all pairs one by one."""

import numpy as np
import pytest
from numba import njit
from test_gap import curves
from twins import pairs_that_count

from rodsim.forces import blocks
from rodsim.forces.near import pairs_within
from rodsim.nodes import lay_out


def scene(kind, seed):
    """Return positions, rods and excluded segments of rods that are near to each other."""
    X, counts, closed = curves(kind, seed)
    rods = lay_out((f"r{i}", n, c, 0.3, [0.7] * 6) for i, (n, c) in
                   enumerate(zip(counts, closed, strict=True)))  # fmt: skip
    excluded = np.random.default_rng(seed + 7).integers(0, 12, size=len(counts))
    return np.ascontiguousarray(X), rods, excluded


@pytest.mark.parametrize("kind", ["coil", "ring", "walk", "rods"])
def test_the_points_within_a_reach_are_those_of_all_pairs(kind):
    reach, found = {"coil": 0.31, "ring": 0.2, "walk": 1.9, "rods": 2.3}[kind], 0
    for seed in range(5):
        X, rods, excluded = scene(kind, seed)
        pairs = blocks.near_points(X, rods.first, rods.count, rods.closed, excluded, reach)
        expected = {
            pair: d for pair, d in pairs_that_count(X.T, rods, excluded).items() if d < reach
        }
        assert {(i, j) for i, j, _, _ in pairs.tolist()} == expected.keys()
        assert len(pairs) == len(expected)  # none twice
        for i, j, r, s in pairs.tolist():
            assert [rods.locate(i)[0], rods.locate(j)[0]] == [rods.names[r], rods.names[s]]
        first, second, distance = pairs_within(X, rods, excluded, reach)
        assert dict(zip(zip(first.tolist(), second.tolist(), strict=True), distance,
                        strict=True)) == pytest.approx(expected, rel=1e-14)  # fmt: skip
        found += len(expected)
    assert found > 100


@njit
def block_pairs(X, first, count, reach):
    """Return the pairs of blocks, looked for in both ways."""
    table, radius = blocks.blocks_of(X, first, count)
    return (
        blocks._all_pairs(X, table, radius, reach),
        blocks._pairs_in_cells(X, table, radius, reach),
    )


@pytest.mark.parametrize("kind", ["coil", "ring", "walk", "rods"])
@pytest.mark.parametrize("far", [0.0, 1e9])
def test_cells_find_the_blocks_that_all_pairs_find(kind, far):
    """Also far from the origin, on both sides of it, and where rods are far from each other."""
    for seed in range(4):
        X, rods, _ = scene(kind, seed)
        X[:, rods.count[0] // 2 :] += far
        every, in_cells = block_pairs(X, rods.first, rods.count, 0.4)
        assert sorted(map(tuple, in_cells)) == sorted(map(tuple, every))


def test_many_blocks_are_looked_for_in_cells():
    """A sheet of so many rods that cells take over: each point has its neighbours on both sides."""
    side, long = 40, 130
    k = np.arange(side * long)
    X = np.array([0.5 * (k // long), 0.0 * k, 0.11 * (k % long)])
    first, count = long * np.arange(side), np.full(side, long)
    excluded, closed = np.full(side, 8), np.zeros(side, dtype=bool)
    table, _ = blocks.blocks_of(X, first, count)
    assert len(table) > blocks.FEW
    pairs = blocks.near_points(X, first, count, closed, excluded, 0.505)
    assert len(pairs) == (side - 1) * long
    assert (pairs[:, 1] - pairs[:, 0] == long).all()
