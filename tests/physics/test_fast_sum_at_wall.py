"""The fast sums above a plane wall against the exact ones, and the properties they share."""

import numba
import numpy as np
import pytest
from curves import random_loads, suspension

from rodsim import velocity
from rodsim.errors import UsageError
from rodsim.flows.fast.plan import RodSum, relative_error
from rodsim.scene.shapes import rotation_matrix

EPSILON, VISCOSITY, WALL = 0.5, 0.7, -0.3
COUNTS = (1, 3, 411, 17, 380, 2, 264)
N = sum(COUNTS)
FLUID = {"wall": WALL}
FAST = {"wall": WALL, "rods": COUNTS}

pytestmark = pytest.mark.compiled


def above(flat=1.0):
    """Points from 1.3 epsilon above the wall on; ``flat`` presses them down to it."""
    X = suspension(COUNTS)
    X[:, 2] = WALL + 1.3 * EPSILON + flat * (X[:, 2] - X[:, 2].min())
    return X, *random_loads(N, EPSILON)


def error(found, exact):
    return [np.linalg.norm(f - e) / np.linalg.norm(e) for f, e in zip(found, exact, strict=True)]


@pytest.mark.parametrize("flat", [1.0, 0.02])
@pytest.mark.parametrize("accuracy", [1e-2, 1e-3, 1e-5, 1e-8])
def test_the_error_is_within_what_was_asked(accuracy, flat):
    X, g, m = above(flat)
    exact = velocity(X, X, g, m, EPSILON, VISCOSITY, **FLUID)
    fast = velocity(X, X, g, m, EPSILON, VISCOSITY, accuracy=accuracy, **FAST)
    # It is asked for at 64 points, and holds for all of them to within the scatter of 64.
    assert 1e-13 < max(error(fast, exact)) <= 1.3 * accuracy
    # Also for those close to the wall, where all is slow.
    low = X[:, 2] < WALL + 3.0 * EPSILON
    assert max(error([f[low] for f in fast], [e[low] for e in exact])) <= 2.0 * accuracy


@pytest.mark.long
def test_the_other_blob_has_it_too():
    X, g, m = above()
    exact = velocity(X, X, g, m, EPSILON, VISCOSITY, blob="algebraic9", **FLUID)
    fluid = {"blob": "algebraic9", "accuracy": 1e-5, **FAST}
    fast = velocity(X, X, g, m, EPSILON, VISCOSITY, **fluid)
    assert 1e-13 < max(error(fast, exact)) <= 1.3e-5


def test_other_targets_see_the_same_flow_down_to_the_wall():
    X, g, m = above()
    rng = np.random.default_rng(1)
    targets = np.concatenate([rng.uniform(-25, 25, (500, 3)), X[:200]])
    on_wall = slice(0, 40)
    targets[on_wall, 2] = WALL
    exact = velocity(targets, X, g, m, EPSILON, VISCOSITY, angular=False, **FLUID)[0]
    fast = velocity(targets, X, g, m, EPSILON, VISCOSITY, angular=False, accuracy=1e-5, **FAST)[0]
    below = targets[:, 2] < WALL
    assert 100 < below.sum() < 400
    assert np.isnan(fast[below]).all()
    assert max(error([fast[~below]], [exact[~below]])) <= 1.3e-5
    # The kernel is 0 there, so no interpolation of it is anything else; rounding of free terms.
    free = velocity(targets[on_wall], X, g, m, EPSILON, VISCOSITY, angular=False)[0]
    assert abs(fast[on_wall]).max() <= 1e-14 * abs(free).max()
    down = targets.copy()
    down[:, 2] = WALL - 1.0
    nowhere = velocity(down, X, g, m, EPSILON, VISCOSITY, angular=False, accuracy=1e-5, **FAST)[0]
    assert np.isnan(nowhere).all()


@pytest.mark.long
def test_a_planar_sum_stays_in_its_plane():
    s = 0.1 * np.arange(900)
    points = np.ascontiguousarray([0.83 + 0.0 * s, s, WALL + 4.0 + 3.0 * np.sin(0.3 * s)])
    loads = np.random.default_rng(5).normal(size=(6, 900))
    loads[[0, 4, 5]] = 0.0
    out, exact = np.zeros((2, 6, 900))
    fast = RodSum([900], 1e-6, EPSILON, VISCOSITY, "algebraic7", True, WALL)
    fast.kernel(fast.prepare(points, loads), points, loads, False, out)
    fast.exact(points, points, loads, EPSILON, VISCOSITY, WALL, exact)
    assert relative_error(out, exact).max() <= 1.3e-6
    assert not out[[0, 4, 5]].any()


def test_the_mobility_is_symmetric():
    X, *b = above()
    a = random_loads(N, EPSILON, seed=29)
    u, w = velocity(X, X, *a, EPSILON, VISCOSITY, accuracy=1e-3, **FAST)
    v, z = velocity(X, X, *b, EPSILON, VISCOSITY, accuracy=1e-3, **FAST)
    left, right = (u * b[0]).sum() + (w * b[1]).sum(), (v * a[0]).sum() + (z * a[1]).sum()
    scale = np.linalg.norm(u) * np.linalg.norm(b[0])
    assert left == pytest.approx(right, abs=1e-14 * scale)


def test_it_turns_about_the_normal_and_moves_along_the_wall():
    X, g, m = above()
    turn, shift = rotation_matrix((0.0, 0.0, 1.0), 1.234), np.array([4.0, -3.0, 11.0])
    u, w = velocity(X, X, g, m, EPSILON, VISCOSITY, accuracy=1e-3, **FAST)
    Y, moved = X @ turn.T + shift, FAST | {"wall": WALL + shift[2]}
    v, z = velocity(Y, Y, g @ turn.T, m @ turn.T, EPSILON, VISCOSITY, accuracy=1e-3, **moved)
    # Other lists would show as 1e-4; places of size 30 carry rounding of 4e-15, over eps 0.5.
    assert v == pytest.approx(u @ turn.T, abs=1e-12 * abs(u).max())
    assert z == pytest.approx(w @ turn.T, abs=1e-12 * abs(w).max())


def test_one_thread_and_two_give_the_same_bits():
    X, g, m = above()
    results = []
    for threads in (1, min(2, numba.config.NUMBA_NUM_THREADS)):
        numba.set_num_threads(threads)
        results.append(velocity(X, X, g, m, EPSILON, VISCOSITY, accuracy=1e-5, **FAST))
    numba.set_num_threads(numba.config.NUMBA_NUM_THREADS)
    assert np.array_equal(*results)


def test_far_above_the_wall_it_is_the_free_sum():
    """What is left is the images' field, 9/8 of the free self mobility times epsilon over h."""
    X, g, m = above()
    free = velocity(X, X, g, m, EPSILON, VISCOSITY, accuracy=1e-5, rods=COUNTS)[0]
    gaps = []
    for height in (1e5, 1e6):
        far = FAST | {"wall": WALL - height}
        gaps.append(velocity(X, X, g, m, EPSILON, VISCOSITY, accuracy=1e-5, **far)[0] - free)
    assert abs(gaps[1]).max() == pytest.approx(0.1 * abs(gaps[0]).max(), rel=1e-2)
    assert abs(gaps[1]).max() < 1e-4 * abs(free).max()


def test_a_source_at_the_wall_is_named():
    X, g, m = above()
    X[33, 2] = WALL
    with pytest.raises(UsageError, match=r"source 33 is at z = -0\.3"):
        velocity(X, X, g, m, EPSILON, VISCOSITY, accuracy=1e-3, **FAST)
