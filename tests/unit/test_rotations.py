import numpy as np
import pytest
from scipy.linalg import expm

from rodsim.compiled.rotations import rotate, rotation_vector_rate


def cross_matrix(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-5, 1.01e-4, 0.7, 3.1, 40.0])
def test_rotate_is_the_matrix_exponential(angle):
    axis = np.array([0.48, -0.6, 0.64])
    theta = (angle * axis)[:, None].repeat(2, axis=1)
    D = np.random.default_rng(1).normal(size=(3, 3, 2))
    out = np.empty_like(D)
    rotate(theta, D, out)
    expected = np.einsum("ab,ibk->iak", expm(cross_matrix(angle * axis)), D)
    assert out == pytest.approx(expected, abs=2e-13)  # expm of a norm of 40


def test_no_rotation_leaves_every_bit():
    D = np.random.default_rng(2).normal(size=(3, 3, 4))
    out = np.empty_like(D)
    rotate(np.zeros((3, 4)), D, out)
    assert np.array_equal(out, D)


def test_triads_stay_orthonormal_over_many_steps():
    rng = np.random.default_rng(3)
    D = np.ascontiguousarray(np.repeat(np.eye(3)[:, :, None], 5, axis=2))
    for _ in range(10_000):
        rotate(0.01 * rng.normal(size=(3, 5)), D, D)
    gram = np.einsum("ick,jck->ijk", D, D)
    # Rounding 1e-16 a step, walking at random: about 1e-14 after 10^4 steps.
    assert abs(gram - np.eye(3)[:, :, None]).max() < 1e-13


@pytest.mark.parametrize(("scale", "order"), [(0.2, 4)])
def test_rate_of_the_rotation_vector(scale, order):
    """d/dt exp(theta(t)) = w exp(theta): the series errs by theta^4 |w|/720, seen as order 4."""
    theta, w = scale * np.array([0.5, -0.7, 0.4]), np.array([1.3, 0.6, -0.9])

    def error(size):
        t = theta * size
        rate = w[:, None].copy()
        rotation_vector_rate(t[:, None], rate)
        h = 1e-5
        up, down = (expm(cross_matrix(t + sign * h * rate[:, 0])) for sign in (1, -1))
        spin = (up - down) / (2 * h) @ expm(cross_matrix(t)).T
        return abs(spin - cross_matrix(w)).max()

    assert error(1.0) < scale**4 * np.linalg.norm(w) / 720
    assert np.log2(error(8.0) / error(4.0)) == pytest.approx(order, abs=0.3)
