"""The fast sums against the exact ones, and the properties that must not be lost on the way."""

import numba
import numpy as np
import pytest
from curves import random_loads, suspension

from rodsim import velocity
from rodsim.errors import UsageError
from rodsim.flows.fast import plan
from rodsim.flows.fast.arcs import PROXIES
from rodsim.flows.fast.plan import RodSum, relative_error
from rodsim.scene.shapes import rotation_matrix

EPSILON, VISCOSITY = 0.5, 0.7
COUNTS = (1, 3, 411, 17, 780, 2, 264)
N = sum(COUNTS)


@pytest.fixture(scope="module")
def sources():
    return suspension(COUNTS), *random_loads(N, EPSILON)


def error(found, exact):
    return [np.linalg.norm(f - e) / np.linalg.norm(e) for f, e in zip(found, exact, strict=True)]


@pytest.mark.compiled
@pytest.mark.parametrize(
    ("blob", "accuracy"),
    [("algebraic7", a) for a in (1e-2, 1e-3, 1e-5, 1e-7, 1e-10)] + [("algebraic9", 1e-5)],
)
def test_the_error_is_within_what_was_asked(sources, blob, accuracy):
    X, g, m = sources
    exact = velocity(X, X, g, m, EPSILON, VISCOSITY, blob=blob)
    fast = velocity(X, X, g, m, EPSILON, VISCOSITY, blob=blob, accuracy=accuracy, rods=COUNTS)
    # It is asked for at 64 points, and holds for all of them to within the scatter of 64.
    assert max(error(fast, exact)) <= 1.3 * accuracy
    assert max(error(fast, exact)) > 1e-13  # it is not the exact sum


@pytest.mark.compiled
def test_other_targets_see_the_same_flow_wherever_they_are(sources):
    X, g, m = sources
    targets = np.concatenate([np.random.default_rng(1).uniform(-25, 25, (500, 3)), X[:300]])
    exact = velocity(targets, X, g, m, EPSILON, VISCOSITY)
    fast = velocity(targets, X, g, m, EPSILON, VISCOSITY, accuracy=1e-5, rods=COUNTS)
    assert max(error(fast, exact)) <= 1.3e-5
    u, nothing = velocity(
        targets, X, g, m, EPSILON, VISCOSITY, accuracy=1e-5, rods=COUNTS, angular=False
    )
    assert nothing is None
    assert u == pytest.approx(fast[0], abs=1e-13 * abs(u).max())


@pytest.mark.compiled
def test_the_error_that_is_measured_is_the_error(sources):
    X, g, m = sources
    points, loads = np.ascontiguousarray(X.T), np.vstack([g.T, m.T]).copy(order="C")
    fast, out = RodSum(COUNTS, 1e-5, EPSILON, VISCOSITY, "algebraic7"), np.zeros((6, N))
    fast.kernel(fast.prepare(points, loads), points, loads, False, out)
    exact = np.concatenate(velocity(X, X, g, m, EPSILON, VISCOSITY), axis=1).T
    sample = np.unique(np.linspace(0, N - 1, 64).astype(int))
    assert fast.error == pytest.approx(relative_error(out[:, sample], exact[:, sample]), rel=1e-6)


@pytest.mark.compiled
def test_a_rule_that_is_not_good_enough_is_made_stricter(sources, monkeypatch):
    X, g, m = sources
    points, loads = np.ascontiguousarray(X.T), np.vstack([g.T, m.T]).copy(order="C")
    monkeypatch.setattr(plan, "proxies_for", lambda accuracy: 6)
    fast = RodSum(COUNTS, 1e-5, EPSILON, VISCOSITY, "algebraic7")
    bounds, sample = fast.bounds(points), np.arange(0, N, 23)
    first = fast.tables(points, bounds, next(fast.rules()), sample)
    tables, found, exact = fast.prepare(points, loads), np.zeros((6, N)), np.zeros((6, N))
    assert tables.size > first.size
    fast.kernel(first, points, loads, False, found)
    fast.exact(points, points, loads, EPSILON, VISCOSITY, 0.0, exact)
    assert relative_error(found, exact).max() > 1e-5 >= fast.error.max()


def test_a_rod_that_winds_gets_more_proxies():
    """Points of 25 a turn; arcs of 8 proxies cannot be longer than a turn or so."""
    s = 0.1 * np.arange(2000)
    axis = np.array([6.0 * np.sin(0.05 * s), 6.0 * np.cos(0.05 * s), 0.1 * s])
    wound = 0.3 * np.array([np.cos(2.5 * s), np.sin(2.5 * s), 0.0 * s])
    chosen, pairs = [], []
    for points in (axis + wound, axis):
        points = np.ascontiguousarray(points)
        fast = plan.rod_sum(points, [2000], 1e-5, EPSILON, VISCOSITY, "algebraic7")
        plain = RodSum([2000], 1e-5, EPSILON, VISCOSITY, "algebraic7")
        for one in (fast, plain):
            one.count(points)
        chosen.append(fast.arcs.nodes[:, PROXIES].max())
        pairs.append(fast.pairs / plain.pairs)
    assert chosen[0] > chosen[1] == 8
    assert pairs[0] < 0.8
    assert pairs[1] == 1.0


@pytest.mark.compiled
def test_a_planar_sum_stays_in_its_plane():
    s = 0.1 * np.arange(900)
    points = np.ascontiguousarray([0.83 + 0.0 * s, 3.0 * np.sin(0.3 * s), s])
    loads = np.random.default_rng(5).normal(size=(6, 900))
    loads[[0, 4, 5]] = 0.0
    out, exact = np.zeros((2, 6, 900))
    for planar in (True, False):
        fast = RodSum([900], 1e-6, EPSILON, VISCOSITY, "algebraic7", planar)
        out[:] = 0.0
        fast.kernel(fast.prepare(points, loads), points, loads, False, out)
        exact[:] = 0.0
        fast.exact(points, points, loads, EPSILON, VISCOSITY, 0.0, exact)
        assert relative_error(out, exact).max() <= 1.3e-6
        if planar:
            assert not out[[0, 4, 5]].any()


@pytest.mark.compiled
def test_the_mobility_is_symmetric(sources):
    X, g, m = sources
    a, b = random_loads(N, EPSILON, seed=29), (g, m)
    u, w = velocity(X, X, *a, EPSILON, VISCOSITY, accuracy=1e-3, rods=COUNTS)
    v, z = velocity(X, X, *b, EPSILON, VISCOSITY, accuracy=1e-3, rods=COUNTS)
    left, right = (u * b[0]).sum() + (w * b[1]).sum(), (v * a[0]).sum() + (z * a[1]).sum()
    scale = np.linalg.norm(u) * np.linalg.norm(b[0])
    assert left == pytest.approx(right, abs=1e-14 * scale)


@pytest.mark.compiled
def test_the_lists_turn_and_move_with_the_scene(sources):
    X, g, m = sources
    turn, shift = rotation_matrix((0.3, -1.2, 0.7), 1.234), np.array([4.0, -3.0, 11.0])
    fast = {"accuracy": 1e-3, "rods": COUNTS}
    u, w = velocity(X, X, g, m, EPSILON, VISCOSITY, **fast)
    Y = X @ turn.T + shift
    v, z = velocity(Y, Y, g @ turn.T, m @ turn.T, EPSILON, VISCOSITY, **fast)
    # Other lists would show as 1e-4; places of size 30 carry rounding of 4e-15, over eps 0.5.
    assert v == pytest.approx(u @ turn.T, abs=1e-12 * abs(u).max())
    assert z == pytest.approx(w @ turn.T, abs=1e-12 * abs(w).max())


@pytest.mark.compiled
def test_one_thread_and_two_give_the_same_bits(sources):
    X, g, m = sources
    results = []
    for threads in (1, min(2, numba.config.NUMBA_NUM_THREADS)):
        numba.set_num_threads(threads)
        own = velocity(X, X, g, m, EPSILON, VISCOSITY, accuracy=1e-5, rods=COUNTS)
        other = velocity(X[::3], X, g, m, EPSILON, VISCOSITY, accuracy=1e-5, rods=COUNTS)
        results.append(np.concatenate([*own, *other]))
    numba.set_num_threads(numba.config.NUMBA_NUM_THREADS)
    assert np.array_equal(*results)


@pytest.mark.compiled
def test_a_frozen_sum_is_smooth_and_one_with_new_lists_is_not(sources):
    """Fourth differences along a smooth path: lists that change put jumps into the velocities."""
    X, g, m = sources
    points, loads = np.ascontiguousarray(X.T), np.vstack([g.T, m.T]).copy(order="C")
    fast = RodSum(COUNTS, 1e-3, EPSILON, VISCOSITY, "algebraic7")
    tables = fast.prepare(points, loads)
    way = np.sin(0.2 * points[::-1]) * 0.4
    jumps = []
    for freeze in (True, False):
        errors = []
        for k in range(9):
            there = np.ascontiguousarray(points + 0.02 * (k - 4) * way)
            out, exact = np.zeros((2, 6, N))
            fast.kernel(tables if freeze else fast.prepare(there, loads), there, loads, False, out)
            fast.exact(there, there, loads, EPSILON, VISCOSITY, 0.0, exact)
            errors.append((out - exact)[:3] / np.linalg.norm(exact[:3]))
        jumps.append(np.linalg.norm(np.diff(errors, n=4, axis=0), axis=(1, 2)).max())
    assert jumps[0] < 1e-2 * jumps[1]


def test_what_cannot_be_done_is_named(sources):
    X, g, m = sources
    for options, words in (
        ({"accuracy": 0.3}, "between 1e-12 and 0.1"),
        ({"accuracy": 1e-4, "rods": (N - 1, 2)}, f"add up to {N}"),
        ({"rods": (N,)}, "give accuracy too"),
    ):
        with pytest.raises(UsageError, match=words):
            velocity(X, X, g, m, EPSILON, VISCOSITY, **options)
