"""Points near to each other, by blocks, by cells and sorted, against all pairs one by one."""

import numpy as np
import pytest
from numba import njit
from test_gap import curves
from twins import pairs_that_count

from rodsim.forces import spheres
from rodsim.forces.near import pairs_within
from rodsim.nodes import lay_out


def scene(kind, seed):
    """Return positions, rods and excluded segments of rods that are near to each other."""
    X, counts, closed = curves(kind, seed)
    rods = lay_out((f"r{i}", n, c, 0.3, [0.7] * 6) for i, (n, c) in
                   enumerate(zip(counts, closed, strict=True)))  # fmt: skip
    excluded = np.random.default_rng(seed + 7).integers(0, 12, size=len(counts))
    return np.ascontiguousarray(X), rods, excluded


@njit
def near_pairs(X, rods, excluded, reach):
    """Return all pairs of points, block by block, as contact goes through them."""
    table, radius = spheres.blocks_of(X, rods[0], rods[1])
    found, near = [], np.empty((spheres.BLOCK**2, 2), dtype=np.uint64)
    counting = rods[1], rods[2], excluded
    for a, b in spheres.near_blocks(X, table, radius, reach):
        n = spheres.points_within(X, table, radius, a, b, counting, reach, near)
        found.append(near[:n].copy())
    return found


def near_points(*arguments):
    return [(int(i), int(j)) for block in near_pairs(*arguments) for i, j in block]


@pytest.mark.parametrize("kind", ["coil", "ring", "walk", "rods"])
def test_the_points_within_a_reach_are_those_of_all_pairs(kind):
    reach, found = {"coil": 0.31, "ring": 0.2, "walk": 1.9, "rods": 2.3}[kind], 0
    for seed in range(5):
        X, rods, excluded = scene(kind, seed)
        pairs = near_points(X, rods.tables, excluded, reach)
        expected = {
            pair: d for pair, d in pairs_that_count(X.T, rods, excluded).items() if d < reach
        }
        assert sorted(pairs) == sorted(expected)  # none twice
        first, second, distance = pairs_within(X, rods, excluded, reach)
        assert dict(zip(zip(first.tolist(), second.tolist(), strict=True), distance,
                        strict=True)) == pytest.approx(expected, rel=1e-14)  # fmt: skip
        found += len(expected)
    assert found > 100


@njit
def block_pairs(X, first, count, reach):
    """Return the pairs of blocks, looked for in both ways."""
    table, radius = spheres.blocks_of(X, first, count)
    return (
        spheres._all_pairs(X, table, radius, reach),
        spheres._pairs_in_cells(X, table, radius, reach),
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


def test_cells_look_into_all_directions():
    """A cloud of short rods: every one of the 27 cells holds one that is near."""
    rng = np.random.default_rng(11)
    middle = rng.uniform(-2.0, 2.0, size=(3, 500))
    X = np.repeat(middle, 2, axis=1) + rng.normal(scale=0.05, size=(3, 1000))
    rods = lay_out((f"r{i}", 2, False, 0.1, [0.7] * 6) for i in range(500))
    every, in_cells = block_pairs(X, rods.first, rods.count, 0.6)
    assert sorted(map(tuple, in_cells)) == sorted(map(tuple, every))
    assert len(every) > 4000


def test_many_blocks_are_looked_for_in_cells():
    """A sheet of so many rods that cells take over: each point has its neighbours on both sides."""
    side, long = 40, 130
    k = np.arange(side * long)
    X = np.array([0.5 * (k // long), 0.0 * k, 0.11 * (k % long)])
    rods = lay_out((f"r{i}", long, False, 0.11, [0.7] * 6) for i in range(side))
    table, _ = spheres.blocks_of(X, rods.first, rods.count)
    assert len(table) > spheres.FEW
    pairs = near_points(X, rods.tables, np.full(side, 8), 0.505)
    assert len(pairs) == (side - 1) * long
    assert {j - i for i, j in pairs} == {long}
