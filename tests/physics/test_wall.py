"""The sums at a plane wall: a twin, the equations they solve, symmetries, what the library says."""

import numba
import numpy as np
import pytest
import wall_twin

from rodsim import pressure, velocity
from rodsim.errors import UsageError
from rodsim.flows.blobs import BLOBS
from rodsim.flows.by_threads import velocity_kernel
from rodsim.scene.shapes import rotation_matrix

EPSILON, VISCOSITY, WALL = 0.31, 2.7e-3, -0.73
both_blobs = pytest.mark.parametrize("blob", BLOBS)


def clouds(targets=5, sources=7, seed=4, low=0.05):
    """Targets, sources, forces, torques with no symmetry; points from ``low`` above the wall."""
    rng = np.random.default_rng(seed)
    arrays = [rng.normal(size=(n, 3)) for n in (targets, sources, sources, sources)]
    for points in arrays[:2]:
        points[:, 2] = WALL + low + abs(points[:, 2])
    return arrays


def at_wall(arrays, blob, wall=WALL):
    """Return u beside w, (T, 6)."""
    return np.hstack(velocity(*arrays, EPSILON, VISCOSITY, blob=blob, wall=wall))


@both_blobs
def test_sums_equal_their_twin(blob):
    targets, sources, forces, torques = clouds(2, 2)
    targets[1] = sources[0]
    up = np.array([0.0, 0.0, WALL])
    u, p = np.zeros((2, 6)), np.zeros(2)
    for i, x in enumerate(targets):
        for pair in zip(sources, forces, torques, strict=True):
            pair = x - up, pair[0] - up, *pair[1:]
            u[i] += np.concatenate(wall_twin.velocity(*pair, EPSILON, VISCOSITY, blob))
            p[i] += wall_twin.pressure(*pair, EPSILON, blob)
    rows = at_wall([targets, sources, forces, torques], blob)
    # The twin is exact to its 16 digits; rounding of some hundred operations in the sums.
    assert rows == pytest.approx(u, rel=1e-12, abs=1e-13 * abs(u).max())
    found = pressure(targets, sources, forces, EPSILON, blob=blob, wall=WALL, torques=torques)
    assert found == pytest.approx(p, rel=1e-12)


@both_blobs
@pytest.mark.parametrize("angular", [True, False])
def test_fluid_does_not_slip_on_the_wall(blob, angular):
    targets, *sources = clouds(40)
    targets[:, 2] = WALL
    fluid = {"blob": blob, "angular": angular}
    free = velocity(targets, *sources, EPSILON, VISCOSITY, **fluid)[0]
    u, w = velocity(targets, *sources, EPSILON, VISCOSITY, wall=WALL, **fluid)
    # Every term is 0; a compiler that reorders sums may leave the last bit of one.
    assert abs(u).max() <= 1e-15 * abs(free).max()
    if angular:  # a wall where u = 0 has no vorticity along its normal
        assert abs(w[:, 2]).max() <= 1e-14 * abs(w).max()


def derivative(function, x, axis, h=4e-3):
    """Central difference of order 6; truncation and rounding balance near 1e-11."""
    step = np.eye(3)[axis] * h
    f = [function(x + k * step) for k in (1, 2, 3, -1, -2, -3)]
    return (45 * (f[0] - f[3]) - 9 * (f[1] - f[4]) + (f[2] - f[5])) / (60 * h)


@both_blobs
def test_flow_is_incompressible_and_w_is_half_its_curl(blob):
    targets, *sources = clouds()

    def u(x):
        return at_wall([x, *sources], blob)[:, :3]

    gradient = np.array([derivative(u, targets, axis) for axis in range(3)])  # [axis, t, c]
    size = abs(gradient).max()
    assert np.einsum("ctc->t", gradient) == pytest.approx(0.0, abs=1e-8 * size)
    curl = [gradient[a, :, b] - gradient[b, :, a] for a, b in ((1, 2), (2, 0), (0, 1))]
    w = at_wall([targets, *sources], blob)[:, 3:]
    assert 0.5 * np.transpose(curl) == pytest.approx(w, abs=1e-8 * size)


def mobility(X, blob, epsilon=EPSILON, wall=WALL):
    """The 6 N x 6 N matrix (forces, torques) -> (u, w), lengths over epsilon, without 8 pi mu."""
    points = np.ascontiguousarray((X - [0.0, 0.0, wall]).T / epsilon)
    matrix = np.zeros((6, len(X), 6, len(X)))  # load and its source, motion and its point
    kernel, loads = velocity_kernel(BLOBS[blob], at_wall=True), np.eye(6)[:, :, None]
    for source in range(len(X)):
        place = points[:, source : source + 1].copy()
        for load, out in zip(loads, matrix[:, source], strict=True):
            kernel(points, place, load.copy(), 1.0, 1.0 / (8.0 * np.pi), 0.0, out)
    return matrix.reshape(6 * len(X), -1).T


@both_blobs
def test_grand_mobility_is_symmetric(blob):
    matrix = mobility(clouds(sources=9)[1], blob)
    assert abs(matrix - matrix.T).max() <= 1e-15 * abs(matrix).max()


def lattice(lowest, spacing=0.5, side=5, layers=3):
    steps = spacing * np.arange(side)
    return np.stack(np.meshgrid(steps, steps, lowest + steps[:layers]), axis=-1).reshape(-1, 3)


@pytest.mark.parametrize(("blob", "lowest"), [("algebraic7", 0.6065), ("algebraic9", 0.55)])
def test_grand_mobility_is_positive_definite_down_to_the_rods_own_radius(blob, lowest):
    rng = np.random.default_rng(5)
    dense = lattice(lowest)
    loose = rng.uniform((0, 0, lowest), (6.0, 6.0, 4.0), (40, 3))
    low = rng.uniform((0, 0, lowest), (2.0, 2.0, 1.2), (40, 3))
    for X in (dense, loose, low):
        # Measured, not proved; the smallest of these is 1e-7 of the largest.
        values = np.linalg.eigvalsh(mobility(X, blob, 1.0, 0.0))
        assert values[0] > 1e-9 * values[-1]
    # It is lost further down, gently: a test that sees no more would not see that either.
    values = np.linalg.eigvalsh(mobility(lattice(0.3), blob, 1.0, 0.0))
    assert -0.1 * values[-1] < values[0] < 0.0


@both_blobs
def test_shifts_turns_and_reflections_that_leave_the_wall_leave_the_flow(blob):
    arrays = clouds()
    rows = at_wall(arrays, blob)
    turn, shift = rotation_matrix((0.0, 0.0, 1.0), 1.234), np.array([4.0, -3.0, 0.0])
    mirror = np.diag([-1.0, 1.0, 1.0])
    for matrix, offset, axial in ((turn, shift, 1.0), (mirror, 0 * shift, -1.0)):
        targets, sources, forces, torques = (a @ matrix.T for a in arrays)
        moved = at_wall([targets + offset, sources + offset, forces, axial * torques], blob)
        expected = np.hstack([rows[:, :3] @ matrix.T, axial * rows[:, 3:] @ matrix.T])
        # Positions of size 5 carry rounding of 1e-15 relative to eps 0.3.
        assert moved == pytest.approx(expected, abs=1e-12 * abs(rows).max())
    lifted = [a + up for a, up in zip(arrays, ([0, 0, 2.5],) * 2 + (0,) * 2, strict=True)]
    lifted = at_wall(lifted, blob, 2.5 + WALL)
    assert lifted == pytest.approx(rows, abs=1e-12 * abs(rows).max())


@both_blobs
def test_the_scene_below_the_wall_moves_as_its_mirror_image(blob):
    """Kernels do not ask on which side; with torques and w as axial vectors, to the last bit."""
    targets, sources, forces, torques = (np.ascontiguousarray(a.T) for a in clouds())
    mirror = np.array([[1.0], [1.0], [-1.0]])
    rows = np.zeros((2, 6, targets.shape[1]))
    for out, j in zip(rows, (mirror**2, mirror), strict=True):
        loads = np.concatenate([j * forces, np.prod(j) * j * torques])
        places = (j * (a - WALL * (mirror < 0)) for a in (targets, sources))
        velocity_kernel(BLOBS[blob], at_wall=True)(*places, loads, EPSILON, VISCOSITY, 0.0, out)
    assert np.array_equal(rows[1], rows[0] * np.concatenate([mirror, -mirror]))


@both_blobs
def test_velocity_goes_as_one_over_viscosity_and_lengths_scale(blob):
    arrays = clouds()
    rows = at_wall(arrays, blob)
    thick = velocity(*arrays, EPSILON, 2 * VISCOSITY, blob=blob, wall=WALL)
    assert np.array_equal(2 * np.hstack(thick), rows)  # powers of two are exact
    # Lengths x 2, forces x 4, torques x 8 (a fixed stress): u x 2, w x 1.
    large = [a * scale for a, scale in zip(arrays, (2, 2, 4, 8), strict=True)]
    u, w = velocity(*large, 2 * EPSILON, VISCOSITY, blob=blob, wall=2 * WALL)
    assert np.array_equal(np.hstack([0.5 * u, w]), rows)


@both_blobs
def test_a_wall_far_away_is_felt_as_one_over_its_distance(blob):
    arrays = clouds()
    free = np.hstack(velocity(*arrays, EPSILON, VISCOSITY, blob=blob))[:, :3]
    felt = [abs(at_wall(arrays, blob, -h)[:, :3] - free).max() for h in (500.0, 1000.0)]
    assert felt[0] / felt[1] == pytest.approx(2.0, rel=0.01)  # the next order is 1/h^2
    assert felt[1] < 1e-2 * abs(free).max()


@both_blobs
def test_variants_of_the_sum_agree_and_add_to_what_is_there(blob):
    rng = np.random.default_rng(8)
    X, loads = rng.normal(size=(3, 40)), rng.normal(size=(6, 40))
    X[2] = WALL + 0.1 + abs(X[2])
    X[0], loads[0], loads[4:] = 0.83, 0.0, 0.0
    before = rng.normal(size=(6, 40))
    full = at_wall([X.T, X.T, loads[:3].T, loads[3:].T], blob).T
    for planar, angular in ((False, True), (True, True), (False, False)):
        rows = 6 if angular else 3
        out = before[:rows].copy()
        kernel = velocity_kernel(BLOBS[blob], planar, angular, at_wall=True)
        kernel(X, X, loads, EPSILON, VISCOSITY, WALL, out)
        for part in (slice(0, 3), slice(3, 6))[: rows // 3]:
            # Rounding of 40 terms, and of what was there before.
            found, size = (out - before[:rows])[part], abs(full[part]).max()
            assert found == pytest.approx(full[part], abs=1e-13 * size + 1e-15)


@pytest.mark.compiled
def test_one_thread_and_two_give_the_same_bits():
    targets, sources, forces, torques = clouds(101, 103)
    results = []
    for threads in (1, min(2, numba.config.NUMBA_NUM_THREADS)):
        numba.set_num_threads(threads)
        results.append(at_wall([targets, sources, forces, torques], "algebraic7"))
    numba.set_num_threads(numba.config.NUMBA_NUM_THREADS)
    assert np.array_equal(*results)


def test_there_is_no_fluid_below_the_wall():
    targets, sources, forces, torques = clouds(3)
    fine = at_wall([targets, sources, forces, torques], "algebraic7")
    targets[1, 2] = WALL - 1e-9
    rows = at_wall([targets, sources, forces, torques], "algebraic7")
    p = pressure(targets, sources, forces, EPSILON, wall=WALL, torques=torques)
    assert np.isnan(rows[1]).all()
    assert np.isnan(p).tolist() == [False, True, False]
    assert np.array_equal(rows[::2], fine[::2])


def test_bad_arguments_are_named():
    targets, sources, forces, torques = clouds()
    sources[3, 2], sources[5, 2] = WALL, WALL - 1.0
    rest = forces, torques, EPSILON, VISCOSITY
    with pytest.raises(UsageError, match=r"source 3 is at z = -0\.73: .*above the wall z = -0\.73"):
        velocity(targets, sources, *rest, wall=WALL)
    with pytest.raises(UsageError, match="source 3 is at z"):
        pressure(targets, sources, forces, EPSILON, wall=WALL, torques=torques)
    with pytest.raises(UsageError, match="wall must be a height z or None, not nan"):
        velocity(targets, sources, *rest, wall=np.nan)
    with pytest.raises(UsageError, match=r"torques make pressure too: give torques="):
        pressure(targets, sources, forces, EPSILON, wall=WALL - 2.0)
