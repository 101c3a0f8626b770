"""The error that a step leaves, in one compiled pass, against the formulas in NumPy."""

import numpy as np
import pytest

from rodsim.compiled.passes import remaining
from rodsim.integrators.defect import MEMORY
from rodsim.integrators.rkc import coefficients, error_constant

SIZE, CONSTANT = 0.37, 0.066
FIRST, COUNT, TRACERS = np.array([0, 5]), np.array([5, 3]), 4
ROUNDING = 1e-13  # of the largest number: some 20 operations each


@pytest.fixture
def numbers():
    """Increments, velocities, rates at the start, correction (6 N + 3 P + 2), and weights."""
    rng = np.random.default_rng(11)
    n = COUNT.sum()
    size = 6 * n + 3 * TRACERS
    return *rng.normal(size=(4, size + 2)), rng.uniform(0.2, 3.0, size)


def rates(y, velocities):
    """Return dy/dt: w becomes w - 1/2 theta x w + 1/12 theta x (theta x w)."""
    n, f = COUNT.sum(), velocities.copy()
    theta, w = (x[3 * n : 6 * n].reshape(3, n) for x in (y, velocities))
    turned = np.cross(theta, w, axis=0)
    f[3 * n : 6 * n] = (w - turned / 2 + np.cross(theta, turned, axis=0) / 12).ravel()
    return f


def size_of(error, weights):
    """Return the largest root mean square of a rod's numbers, or of the tracers'."""
    n = COUNT.sum()
    scaled = (weights * error[: weights.size]) ** 2
    nodes = scaled[: 6 * n].reshape(6, n)
    rods = [nodes[:, k : k + m].mean() for k, m in zip(FIRST, COUNT, strict=True)]
    return np.sqrt(max(*rods, scaled[6 * n :].mean()))


def given(memory, y, velocities, f0, g, weights):
    """Return the size of the error and the rates at the end, as the compiled pass gives them."""
    f1, third, error = np.empty((3, y.size))
    step = SIZE, CONSTANT, memory, y, velocities, f0, g
    return remaining(*step, weights, FIRST, COUNT, f1, third, error), f1, third


@pytest.mark.parametrize("corrected", [True, False])
def test_the_error_left_by_a_step(numbers, corrected):
    y, velocities, f0, g, weights = numbers
    memory, g = (MEMORY, g) if corrected else (1.0, 0.0 * g)
    size, given_f1, third = given(memory, y, velocities, f0, g, weights)
    f1 = rates(y, velocities)
    rest = SIZE * (f0 + f1) / 2 - y + memory * SIZE * g
    error = CONSTANT * rest / (1 / 12 + memory * CONSTANT) - SIZE * g
    np.testing.assert_allclose(given_f1, f1, rtol=0, atol=ROUNDING * np.abs(f1).max())
    expected = rest / (1 / 12 + memory * CONSTANT) / SIZE**3
    np.testing.assert_allclose(third, expected, rtol=0, atol=ROUNDING * np.abs(expected).max())
    assert size == pytest.approx(size_of(error, weights), rel=ROUNDING)


def test_an_error_that_is_no_number_shows(numbers):
    y, velocities, f0, g, weights = numbers
    velocities[2] = np.nan
    assert np.isnan(given(MEMORY, y, velocities, f0, g, weights)[0])


@pytest.mark.parametrize("s", [4, 7, 31])
def test_the_error_constant_is_what_a_step_errs_in_a_linear_problem(s):
    """On y' = z y, h = 1: y_1 - exp(z) = -C z^3 + O(z^4), from differences of z = 1e-2, -1e-2."""
    table = coefficients(s)

    def step(z):
        before, here = 1.0, 1.0 + table[1, 2] * z
        for mu, nu, mu_tilde, gamma_tilde, _ in table[2:]:
            new = (1 - mu - nu) + mu * here + nu * before + z * (mu_tilde * here + gamma_tilde)
            before, here = here, new
        return here

    z = 1e-2
    odd = (step(z) - np.exp(z)) - (step(-z) - np.exp(-z))
    assert -odd / (2 * z**3) == pytest.approx(error_constant(s), rel=1e-4)  # O(z^2)
