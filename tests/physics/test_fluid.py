"""The fused sums: against a twin, against the equations they solve, and their symmetries."""

import numba
import numpy as np
import pytest
import twins

from rodsim import pressure, velocity
from rodsim.errors import UsageError
from rodsim.flows.velocity import BLOBS, velocity_kernel
from rodsim.scene.shapes import rotation_matrix

EPSILON, VISCOSITY = 0.31, 2.7e-3
both_blobs = pytest.mark.parametrize("blob", BLOBS)


def clouds(targets=5, sources=7, seed=4):
    """Targets, sources, forces, torques with no symmetry."""
    rng = np.random.default_rng(seed)
    return [rng.normal(size=(n, 3)) for n in (targets, sources, sources, sources)]


@both_blobs
def test_sums_equal_their_twin(blob):
    arrays = clouds()
    u, w = velocity(*arrays, EPSILON, VISCOSITY, blob=blob)
    expected = twins.velocity(*arrays, EPSILON, VISCOSITY, blob)
    # Same formula, another order of summation: rounding of 7 terms.
    assert u == pytest.approx(expected[0], rel=1e-12, abs=1e-12 * abs(expected[0]).max())
    assert w == pytest.approx(expected[1], rel=1e-12, abs=1e-12 * abs(expected[1]).max())


@both_blobs
def test_without_the_angular_part_the_velocity_is_the_same(blob):
    arrays = clouds()
    u, _ = velocity(*arrays, EPSILON, VISCOSITY, blob=blob)
    alone, nothing = velocity(*arrays, EPSILON, VISCOSITY, blob=blob, angular=False)
    assert nothing is None
    assert alone == pytest.approx(u, rel=1e-13, abs=1e-13 * abs(u).max())


def derivative(function, x, axis, h=2e-3):
    """Central difference of order 6; truncation and rounding balance near 1e-11."""
    step = np.eye(3)[axis] * h
    f = [function(x + k * step) for k in (1, 2, 3, -1, -2, -3)]
    return (45 * (f[0] - f[3]) - 9 * (f[1] - f[4]) + (f[2] - f[5])) / (60 * h)


@both_blobs
def test_flow_is_incompressible_and_w_is_half_its_curl(blob):
    targets, sources, forces, torques = clouds()

    def u(x):
        return velocity(x, sources, forces, torques, EPSILON, VISCOSITY, blob=blob)[0]

    gradient = np.array([derivative(u, targets, axis) for axis in range(3)])  # [axis, t, c]
    size = abs(gradient).max()
    assert np.einsum("ctc->t", gradient) == pytest.approx(0.0, abs=1e-8 * size)
    curl = np.stack(
        [gradient[(c + 1) % 3, :, (c + 2) % 3] - gradient[(c + 2) % 3, :, (c + 1) % 3]
         for c in range(3)], axis=1)  # fmt: skip
    w = velocity(targets, sources, forces, torques, EPSILON, VISCOSITY, blob=blob)[1]
    assert 0.5 * curl == pytest.approx(w, abs=1e-8 * size)


@both_blobs
def test_flow_and_pressure_solve_the_stokes_equations(blob):
    """-grad p + mu Delta u + f psi = 0 for a point force: the pressure (62) fits the flow."""
    source, force = np.zeros((1, 3)), np.array([[0.7, -1.3, 0.4]])
    x = np.array([[0.23, -0.41, 0.37]])

    def u(y):
        return velocity(y, source, force, 0 * force, EPSILON, VISCOSITY, blob=blob)[0]

    def p(y):
        return pressure(y, source, force, EPSILON, blob=blob)

    h, laplacian = 4e-3, 0.0
    for axis in range(3):
        e = np.eye(3)[axis] * h
        near, far = u(x + e) + u(x - e), u(x + 2 * e) + u(x - 2 * e)
        laplacian = laplacian + (16 * near - far - 30 * u(x)) / (12 * h**2)
    gradient = np.array([derivative(p, x, axis)[0] for axis in range(3)])
    body = force[0] * twins.psi(blob, np.linalg.norm(x), EPSILON)
    residual = -gradient + VISCOSITY * laplacian[0] + body
    # Fourth-order differences at h = eps/80: relative error of a few 1e-6.
    assert residual == pytest.approx(0.0, abs=1e-5 * abs(body).max())


def test_self_terms_of_a_single_point():
    force, torque = np.array([[0.2, -0.9, 1.7]]), np.array([[1.1, 0.3, -0.6]])
    u, w = velocity(np.zeros((1, 3)), np.zeros((1, 3)), force, torque, EPSILON, VISCOSITY)
    assert u == pytest.approx(force / (4 * np.pi * VISCOSITY * EPSILON), rel=1e-14)
    assert w == pytest.approx(5 * torque / (16 * np.pi * VISCOSITY * EPSILON**3), rel=1e-14)


@both_blobs
def test_velocity_goes_as_one_over_viscosity_and_lengths_scale(blob):
    targets, sources, forces, torques = clouds()
    u, w = velocity(targets, sources, forces, torques, EPSILON, VISCOSITY, blob=blob)
    thick = velocity(targets, sources, forces, torques, EPSILON, 2 * VISCOSITY, blob=blob)
    assert np.array_equal(2 * thick[0], u)  # powers of two are exact
    assert np.array_equal(2 * thick[1], w)
    # Lengths x 2, forces x 4, torques x 8 (a fixed stress): u x 2, w x 1.
    large = velocity(
        2 * targets, 2 * sources, 4 * forces, 8 * torques, 2 * EPSILON, VISCOSITY, blob=blob
    )
    assert np.array_equal(large[0], 2 * u)
    assert np.array_equal(large[1], w)


@both_blobs
def test_turning_and_moving_the_scene_turns_the_flow(blob):
    targets, sources, forces, torques = clouds()
    turn, shift = rotation_matrix((0.3, -1.2, 0.7), 1.234), np.array([4.0, -3.0, 11.0])
    u, w = velocity(targets, sources, forces, torques, EPSILON, VISCOSITY, blob=blob)
    turned = velocity(
        targets @ turn.T + shift, sources @ turn.T + shift, forces @ turn.T, torques @ turn.T,
        EPSILON, VISCOSITY, blob=blob)  # fmt: skip
    # Positions of size 10 carry rounding of 1e-15 relative to eps 0.3.
    assert turned[0] == pytest.approx(u @ turn.T, abs=1e-12 * abs(u).max())
    assert turned[1] == pytest.approx(w @ turn.T, abs=1e-12 * abs(w).max())


@both_blobs
def test_grand_mobility_is_symmetric_and_positive_definite(blob):
    """The 6 N x 6 N matrix (forces, torques) -> (u, w), at its own sources."""
    X = clouds(sources=4)[1]
    columns = []
    for unit in np.eye(24):
        loads = unit.reshape(2, 4, 3)
        columns.append(np.ravel(velocity(X, X, *loads, EPSILON, VISCOSITY, blob=blob)))
    mobility = np.array(columns).T
    assert mobility == pytest.approx(mobility.T, abs=1e-12 * abs(mobility).max())
    if blob == "algebraic7":  # (13) changes sign, so its mobility need not be definite
        assert np.linalg.eigvalsh(0.5 * (mobility + mobility.T)).min() > 0


def test_uniformly_loaded_line_moves_as_the_integral_says():
    """Midpoint of a straight line, L = 10, eps = 0.1, mu = 1: the closed forms."""
    length, eps, n = 10.0, 0.1, 4000
    s = (np.arange(n) + 0.5) * length / n - 0.5 * length
    line = np.stack([0 * s, 0 * s, s], axis=1)
    for axis, expected in ((2, 0.73295151), (0, 0.44603732)):
        force = np.tile(np.eye(3)[axis] * length / n, (n, 1))
        u, _ = velocity(np.zeros((1, 3)), line, force, 0 * force, eps, 1.0, angular=False)
        # Midpoint rule at ds = eps/40: error below 1e-8; eight printed digits.
        assert u[0, axis] == pytest.approx(expected, abs=2e-8)


@both_blobs
def test_planar_sum_equals_the_spatial_one(blob):
    rng = np.random.default_rng(8)
    X, loads = rng.normal(size=(3, 40)), rng.normal(size=(6, 40))
    X[0], loads[0], loads[4:] = 0.83, 0.0, 0.0
    flat, full = np.zeros((6, 40)), np.zeros((6, 40))
    velocity_kernel(BLOBS[blob], True)(X, X, loads, EPSILON, VISCOSITY, 0.0, flat)
    velocity_kernel(BLOBS[blob], False)(X, X, loads, EPSILON, VISCOSITY, 0.0, full)
    for rows in (slice(0, 3), slice(3, 6)):
        assert flat[rows] == pytest.approx(full[rows], abs=1e-13 * abs(full[rows]).max())


@pytest.mark.compiled
def test_one_thread_and_two_give_the_same_bits():
    X, loads = np.random.default_rng(9).normal(size=(2, 6, 101))
    results = []
    for threads in (1, min(2, numba.config.NUMBA_NUM_THREADS)):
        numba.set_num_threads(threads)
        out = np.zeros((6, 101))
        velocity_kernel(BLOBS["algebraic7"])(X[:3], X[:3], loads, EPSILON, VISCOSITY, 0.0, out)
        results.append(out)
    numba.set_num_threads(numba.config.NUMBA_NUM_THREADS)
    assert np.array_equal(*results)


def test_a_nan_or_an_infinity_shows():
    for bad in (np.nan, np.inf):
        targets, sources, forces, torques = clouds()
        forces[3, 1] = bad
        u, _ = velocity(targets, sources, forces, torques, EPSILON, VISCOSITY)
        assert not np.isfinite(u).any(axis=1).all()


def test_bad_arguments_are_named():
    targets, sources, forces, torques = clouds()
    with pytest.raises(UsageError, match="blob must be one of algebraic7, algebraic9"):
        velocity(targets, sources, forces, torques, EPSILON, VISCOSITY, blob="gauss")
    with pytest.raises(UsageError, match="same number of rows"):
        velocity(targets, sources, forces[1:], torques, EPSILON, VISCOSITY)
    with pytest.raises(UsageError, match=r"shape \(n, 3\)"):
        velocity(targets[:, :2], sources, forces, torques, EPSILON, VISCOSITY)
    with pytest.raises(UsageError, match="viscosity must be > 0"):
        velocity(targets, sources, forces, torques, EPSILON, 0.0)
