"""The scalars of both blobs against their defining identities, by quadrature and differences."""

import numpy as np
import pytest
import twins
from scipy.integrate import quad

from rodsim import velocity
from rodsim.case.materials import WIDTHS
from rodsim.flows.blobs import (
    BLOBS,
    dipole_scalars,
    image_scalars,
    inverse_distance,
    stokeslet_scalars,
)

EPSILON = 0.37
FACTORS = np.array([1, 1, 2, 4, 4])  # of H1, H2, Q/2, D1/4, D2/4
DISTANCES = [0.05, 0.4, 1.3, 6.0]
both_blobs = pytest.mark.parametrize("blob", BLOBS)


def fast_scalars(blob, r, e):
    """The product's formulas, run as plain Python: H1, H2, Q, D1, D2."""
    found = scalars_of(blob, r, e, stokeslet_scalars, dipole_scalars)
    return np.array(found) * FACTORS / (8 * np.pi)


def scalars_of(blob, r, e, *functions):
    """What functions of (blob, 1/R, eps^2) return, times 8 pi, in one list."""
    plain = [getattr(f, "py_func", f) for f in (inverse_distance, *functions)]
    where = BLOBS[blob], plain[0](r * r, e * e), e * e
    return [value for function in plain[1:] for value in function(*where)]


@both_blobs
@pytest.mark.parametrize("r", [0.0, *DISTANCES])
def test_agree_with_the_printed_rational_functions(blob, r):
    # Both are exact; the difference is rounding of about ten operations.
    assert fast_scalars(blob, r, EPSILON) == pytest.approx(
        twins.scalars(blob, r, EPSILON), rel=2e-14, abs=1e-15
    )


def test_values_at_a_point_published_with_the_numerics():
    # mu = eps = 1, x = (1, 2, 2); nine printed digits.
    expected = [0.0138405333, 0.00125823030, 0.00289392970, -0.00270519515, 0.000943672727]
    assert fast_scalars("algebraic7", 3.0, 1.0) == pytest.approx(expected, rel=5e-9)


@both_blobs
def test_blob_integrates_to_one(blob):
    total, _ = quad(
        lambda r: 4 * np.pi * r**2 * twins.psi(blob, r, EPSILON), 0, np.inf, epsabs=1e-11
    )
    assert total == pytest.approx(1.0, abs=1e-8)


@both_blobs
@pytest.mark.parametrize("r", DISTANCES)
def test_q_is_the_enclosed_blob(blob, r):
    """Delta G = psi gives G' = (1/r^2) int_0^r psi x^2 dx, so Q = G'/r = enclosed/(4 pi r^3)."""
    q = fast_scalars(blob, r, EPSILON)[2]
    assert q == pytest.approx(twins.enclosed(blob, r, EPSILON) / (4 * np.pi * r**3), rel=1e-11)


@both_blobs
@pytest.mark.parametrize("r", DISTANCES)
def test_identities_between_the_scalars(blob, r):
    """D1 = psi - Q; D2 = -Q'/r; 3 Q + r Q' = psi; div u = 0: H1' + 4 r H2 + r^2 H2' = 0."""
    h = 1e-4 * r

    def slope(i):  # central difference of order 4: relative error about 1e-13
        f = [fast_scalars(blob, r + k * h, EPSILON)[i] for k in (-2, -1, 1, 2)]
        return (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * h)

    h1, h2, q, d1, d2 = fast_scalars(blob, r, EPSILON)
    psi = twins.psi(blob, r, EPSILON)
    size = abs(q)
    assert d1 == pytest.approx(psi - q, abs=1e-12 * size)
    assert d2 * r == pytest.approx(-slope(2), abs=1e-9 * size / r)
    assert 3 * q + r * slope(2) == pytest.approx(psi, abs=1e-9 * size)
    assert slope(0) + 4 * r * h2 + r**2 * slope(1) == pytest.approx(0.0, abs=1e-9 * h1 / r)


@both_blobs
def test_far_away_they_are_the_singular_stokeslet_rotlet_and_dipole(blob):
    r = 1e4 * EPSILON
    expected = np.array([1 / r, 1 / r**3, 2 / r**3, -2 / r**3, 6 / r**5]) / (8 * np.pi)
    # The next term is of relative order (eps/r)^2 = 1e-8 with factors up to 4.
    assert fast_scalars(blob, r, EPSILON) == pytest.approx(expected, rel=5e-8)


@pytest.mark.parametrize(
    ("blob", "expected"),
    [
        ("algebraic7", [-0.00948683298051, -0.00948683298051, 0.00474341649025, -0.00332039154318]),
        ("algebraic9", [-0.0118585412256, -0.00237170824513, 0.00166019577159, -0.00149417619443]),
    ],
)
def test_values_of_images_at_a_point(blob, expected):
    # eps = 1, x = (1, 2, 2); twelve digits of a separate program.
    assert scalars_of(blob, 3.0, 1.0, image_scalars) == pytest.approx(expected, rel=1e-11)


@both_blobs
@pytest.mark.parametrize("r", DISTANCES)
def test_identities_of_the_scalars_of_images(blob, r):
    """P = H2'/r, E = -(3 H2 + r H2') = H1'/r + H2, E1 = E'/r, E2 = E1'/r; D2 = E1 - 2 P."""
    h = 1e-4 * r

    def values(r):
        return np.array(
            scalars_of(blob, r, EPSILON, stokeslet_scalars, dipole_scalars, image_scalars)
        )

    far = [values(r + k * h) for k in (-2, -1, 1, 2)]
    slope = (far[0] - 8 * far[1] + 8 * far[2] - far[3]) / (12 * h)  # relative error about 1e-13
    h1, h2, half_q, _, quarter_d2, p, e, e1, e_2 = values(r)
    assert slope[1] == pytest.approx(r * p, rel=1e-9)
    assert -3 * h2 - r * slope[1] == pytest.approx(e, abs=1e-9 * h2)
    assert slope[0] / r + h2 == pytest.approx(e, abs=1e-9 * h1 / r**2)
    assert 2 * h2 - 2 * half_q == pytest.approx(e, abs=1e-14 * h2)
    assert slope[6] == pytest.approx(r * e1, rel=1e-9)
    assert slope[7] == pytest.approx(r * e_2, rel=1e-9)
    assert e1 - 2 * p == pytest.approx(4 * quarter_d2, rel=1e-14)


@pytest.mark.parametrize("blob", WIDTHS)
def test_a_line_of_blobs_moves_as_a_cylinder_of_its_radius(blob):
    """Batchelor (1970): 2 ln(2L/a) + 1 across and 4 ln(2L/a) - 2 along, at the middle of 2L."""
    radius, half, spacing = 0.37, 400.0, 0.1
    z = np.arange(-half + spacing / 2, half, spacing)
    sources = np.column_stack([0 * z, 0 * z, z])
    slender = np.log(2 * half / radius)
    for axis, expected in ((0, 2 * slender + 1), (2, 4 * slender - 2)):
        forces = np.zeros_like(sources)
        forces[:, axis] = spacing
        moved = velocity(np.zeros((1, 3)), sources, forces, 0 * forces,
                         epsilon=WIDTHS[blob] * radius, viscosity=0.7, blob=blob)[0]  # fmt: skip
        # the sum is the integral to rounding at five spacings an epsilon; ends: (a/L)^2
        assert 8 * np.pi * 0.7 * moved[0, axis] == pytest.approx(expected, rel=1e-5)
