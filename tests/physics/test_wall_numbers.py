"""The sums at a plane wall and their twin: numbers of a separate program, the Stokes equations."""

import pytest
import wall_twin

from rodsim import pressure, velocity
from rodsim.flows.blobs import BLOBS

PAIRS = {  # target, source, force, torque, epsilon, viscosity; wall z = 0
    1: [(0.37, -0.52, 0.81), (-0.23, 0.44, 0.59), (1.3, -0.7, 2.1), (0.4, 1.7, -0.9), 0.31, 1.7],
    2: [(1.9, 0.6, 0.45), (-1.1, 2.3, 2.6), (-0.8, 1.6, 0.3), (2.2, -0.5, 0.7), 0.85, 0.23],
    3: [(0.21, 0.34, 0.13), (0.25, 0.31, 0.17), (0.6, 1.1, -1.9), (-0.35, 0.27, 0.44), 0.14, 3.1],
    4: [(-2.4, 3.3, 5.2), (1.2, -0.7, 7.9), (12, -5, 7), (31, 17, -23), 0.6, 0.019],
    5: [(0.47, -0.29, 0.36), (0.47, -0.29, 0.36), (0.9, 0.4, -1.4), (0.7, -1.2, 0.3), 0.52, 2.9],
}
NUMBERS = {  # blob, pair: u, w, of a program apart from this one, in 50 digits
    (7, 1): "0.013533579967509 -0.031292415258531 0.00088025766380695"
    " 0.0011752594702781 0.010104086433835 -0.010574399439557",
    (7, 2): "-0.020528372784875 0.020149939671447 -0.00087599447311032"
    " -0.020399425047683 -0.020343327709175 -0.0042515029997152",
    (7, 4): "5.2614454971384 -2.7384784201047 2.4502572383633"
    " -0.24154570927198 0.097665835964865 0.36633978771858",
    (7, 5): "0.025847293488613 0.011056276371673 -0.016409624903593"
    " 0.12986496637797 -0.22207098713232 0.069250761909023",
    (9, 1): "0.013747570933252 -0.033120238324145 0.00061248778694324"
    " 0.00091024613243222 0.0098939824695517 -0.010561893975716",
    (9, 3): "-0.35124691445653 -0.33760375079902 -0.18080742849703"
    " -2.8639272331971 3.8356765505803 4.3390297252767",
    (9, 5): "0.051849749531813 0.023355231656308 -0.038626245044823"
    " 0.37334875056526 -0.64042615622323 0.17742871724806",
}


@pytest.mark.parametrize(("blob", "pair"), NUMBERS)
def test_numbers_of_a_separate_program(blob, pair):
    x, X, g, m, epsilon, viscosity = PAIRS[pair]
    u, w = velocity([x], [X], [g], [m], epsilon, viscosity, blob=f"algebraic{blob}", wall=0.0)
    # They have 14 digits.
    expected = [float(v) for v in NUMBERS[blob, pair].split()]
    assert [*u[0], *w[0]] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("blob", "expected"), [("algebraic7", 0.090940104279678), ("algebraic9", 0.092510734457152)]
)
def test_pressure_of_a_separate_program(blob, expected):
    x, X, g, m, epsilon, _ = PAIRS[1]
    p = pressure([x], [X], [g], epsilon, blob=blob, wall=0.0, torques=[m])
    assert p == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("blob", BLOBS)
def test_twin_solves_the_stokes_equations_outside_its_blobs(blob):
    """mu Laplacian u = grad p, of a force and of a torque: for a small blob, to its square."""
    x, X, g, m, *_ = PAIRS[1]
    for loads in ((g, (0, 0, 0)), ((0, 0, 0), m)):
        residual, slope = wall_twin.stokes_residual(x, X, *loads, 1e-5, 1.7, blob)
        # (eps/r)^2 = 1e-10 with factors of some ten.
        assert abs(residual).max() < 1e-8 * abs(slope).max()
