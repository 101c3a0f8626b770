"""Theory that the sums at a wall must reproduce: point forces, spheres, rods, swimmers."""

import numpy as np
import pytest

from rodsim import velocity
from rodsim.flows.blobs import BLOBS
from rodsim.flows.by_threads import velocity_kernel

EIGHT_PI = 8 * np.pi
MU, EPS = 1.7, 0.21
both_blobs = pytest.mark.parametrize("blob", BLOBS)


def at(x, X, g, m, epsilon=EPS, blob="algebraic7", wall=0.0):
    """Return u and w at one point from loads at points."""
    X, g, m = (np.atleast_2d(np.array(a, float)) for a in (X, g, m))
    u, w = velocity(x, X, g, m, epsilon, MU, blob=blob, wall=wall)
    return u[0], w[0]


def blake(x, X, g, m):
    """Velocity of a point force (Blake 1971) and a point torque (Blake & Chwang 1974) at a wall."""
    h, e3, b = X[2], np.array([0.0, 0.0, 1.0]), g * [1.0, 1.0, -1.0]
    r, R = x - X, x - X * [1.0, 1.0, -1.0]
    r1, R1 = np.linalg.norm(r), np.linalg.norm(R)
    u = g / r1 + g @ r * r / r1**3 - g / R1 - g @ R * R / R1**3
    # 2 h (g_1 d/dR_1 + g_2 d/dR_2 - g_3 d/dR_3) {h R/R^3 - (e3/R + R_3 R/R^3)}
    u += 2 * h * h * (b / R1**3 - 3 * b @ R * R / R1**5)
    u += 2 * h * (b @ R * e3 / R1**3 - (b[2] * R + R[2] * b) / R1**3 + 3 * b @ R * R[2] * R / R1**5)
    n = np.cross(m, e3)
    u += np.cross(m, r) / r1**3 - np.cross(m, R) / R1**3
    u += 2 * h * (n / R1**3 - 3 * n @ R * R / R1**5) + 6 * n @ R * R[2] * R / R1**5
    return u / (EIGHT_PI * MU)


@pytest.mark.parametrize(("blob", "order"), [("algebraic7", 2), ("algebraic9", 4)])
@pytest.mark.parametrize("kind", ["force", "torque"])
def test_a_small_blob_is_blakes_point(blob, order, kind):
    x, X = np.array([0.9, -0.4, 0.7]), np.array([-0.3, 0.5, 1.1])
    load, none = np.array([1.3, -0.7, 2.1]), np.zeros(3)
    loads = (load, none) if kind == "force" else (none, load)
    exact = blake(x, X, *loads)
    errors = [np.linalg.norm(at(x, X, *loads, e, blob)[0] - exact) for e in (0.04, 0.02)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.03)
    assert errors[1] < 30 * 0.02**order * np.linalg.norm(exact)


SPHERES = [  # blob; sphere that moves as the blob: radius over epsilon, of translation and rotation
    ("algebraic7", 2 / 3, (2 / 5) ** (1 / 3)),
    ("algebraic9", 4 / 9, (4 / 25) ** (1 / 3)),
]


@pytest.mark.parametrize(("blob", "moving", "turning"), SPHERES)
def test_a_blob_high_above_the_wall_is_slowed_as_a_sphere(blob, moving, turning):
    place, slowed = [0.3, 0.2, 100 * EPS], []
    for load in np.eye(6):
        motion, free = (
            np.concatenate(at(place, place, load[:3], load[3:], blob=blob, wall=wall)) @ load
            for wall in (0.0, None)
        )
        slowed.append(1 - motion / free)
    a, c = moving / 100, (turning / 100) ** 3
    expected = [9 / 16 * a, 9 / 16 * a, 9 / 8 * a, 5 / 16 * c, 5 / 16 * c, 1 / 8 * c]
    # The next order is (eps/h)^2 = 1e-4; 1 - c has 1e-16/c = 4e-10 of rounding.
    assert slowed == pytest.approx(expected, rel=2e-4)


@pytest.mark.parametrize("h", [0.7 * EPS, 3 * EPS])
def test_self_mobility_in_closed_form(h):
    """algebraic7, T^2 = 4 h^2 + eps^2: the velocity of a blob that is pushed."""
    e, T = EPS, np.sqrt(4 * h * h + EPS * EPS)
    away = 2 / e - 3 / T + e**2 / T**3
    along = 2 / e - 1 / T - e**2 / T**3 - 2 * h**2 * (1 / T**3 - 3 * e**2 / T**5)
    for axis, expected in ((0, along), (1, along), (2, away)):
        u, _ = at([0.0, 0.0, h], [0.0, 0.0, h], np.eye(3)[axis], np.zeros(3))
        assert EIGHT_PI * MU * u[axis] == pytest.approx(expected, rel=1e-13)


def infinite_rod(blob, h):
    """Return 8 pi mu u / f of an infinite rod: along itself, across, away from the wall."""
    p, log = EPS**2 / (4 * h * h + EPS**2), np.log(1 + 4 * h * h / EPS**2)
    if blob == "algebraic7":
        return 2 * log + 2 - 2 * p**2, log + 1 + p - 2 * p**2, log - 1 + p
    along = 2 * log + 4 - 2 * p + 2 * p**2 - 4 * p**3
    return along, log + 2 - p + 3 * p**2 - 4 * p**3, log - p + p**2


@pytest.mark.parametrize(
    ("blob", "h", "printed"),
    [
        ("algebraic7", 0.3, (0.149947030418, 0.0772490035167, 0.0309962207722)),
        ("algebraic7", 0.8, (0.237707074552, 0.119243187077, 0.0724463343502)),
        ("algebraic9", 0.3, (0.192642145472, 0.0968177272008, 0.0495716355290)),
        ("algebraic9", 0.8, (0.283751022277, 0.141888708457, 0.0950654611118)),
    ],
)
def test_infinite_straight_rods(blob, h, printed):
    expected = np.array(infinite_rod(blob, h)) / (EIGHT_PI * MU)
    assert expected == pytest.approx(printed, rel=1e-10)  # a quadrature, good to that
    ds, n = EPS / 5, 40000
    X = np.stack(
        [ds * np.arange(-n, n + 1), np.full(2 * n + 1, 0.4), np.full(2 * n + 1, h)], axis=1
    )
    half = (n + 0.5) * ds  # what is farther away pushes as 12 h^2/x^3 along the rod
    rest = np.array([12 * h**2 / half**2, 0.0, 0.0]) / (EIGHT_PI * MU)
    for axis in range(3):
        force = np.tile(ds * np.eye(3)[axis], (2 * n + 1, 1))
        u, _ = at([0.0, 0.4, h], X, force, 0 * force, blob=blob)
        # The trapezoid rule is exact to exp(-2 pi eps/ds) = 2e-14, the rest to (h/half)^4.
        assert u[axis] + rest[axis] == pytest.approx(expected[axis], rel=1e-10)


def rigid_rod_drag(length, epsilon, h):
    """Drag per length over mu of a rod that translates without turning: along, across, away."""
    n, kernel = round(length / epsilon) + 1, velocity_kernel(BLOBS["algebraic7"], at_wall=True)
    X = np.zeros((3, n))
    X[0], X[2] = np.linspace(0, length, n), h
    matrix = np.zeros((6, n, 6, n))
    for source in range(n):
        for load, out in zip(np.eye(6)[:, :, None], matrix[:, source], strict=True):
            place = X[:, source : source + 1].copy()
            kernel(X, place, load.copy(), epsilon, MU, 0.0, out)
    motions = np.kron(np.eye(6)[:, :3], np.ones((n, 1)))  # one a column: u = x, y or z, w = 0
    loads = np.linalg.solve(matrix.reshape(6 * n, -1).T, motions)
    return [loads[axis * n : (axis + 1) * n, axis].sum() / (length * MU) for axis in range(3)]


@pytest.mark.parametrize(
    ("h", "measured"), [(0.5, (1.044, 1.010, 0.995)), (0.3, (1.032, 0.997, 0.976))]
)
def test_a_slender_rod_near_the_wall_has_the_drag_of_katz(h, measured):
    """Katz, Blake & Paveri-Fontana 1975, for radius << height << length."""
    epsilon, length = 0.1, 20.0
    log = np.log(2 * h / (epsilon * np.exp(-0.5)))
    katz = 2 * np.pi / log, 4 * np.pi / log, 4 * np.pi / (log - 1)
    ratio = rigid_rod_drag(length, epsilon, h) / np.array(katz)
    # 5 %: finite length, 1.3 h/L along the rod; heights from 3 eps to L/40.
    assert ratio == pytest.approx(1.0, rel=0.05)
    assert ratio == pytest.approx(measured, abs=6e-4)  # of a separate program, four digits


@both_blobs
def test_far_field_of_a_force_along_the_wall(blob):
    """12 h z rho (rho.g)/(8 pi mu rho^5): along the separation only, whatever g's direction."""
    h, z, g = 0.9, 1.3, np.array([0.7, -0.4, 0.0])
    for distance, tolerance in ((50.0, 3e-2), (500.0, 3e-4)):  # the next order is 1/r^2
        x = distance * np.array([0.8, 0.6, 0.0])
        u, _ = at(x + np.array([0.0, 0.0, z]), [0.0, 0.0, h], g, np.zeros(3), blob=blob)
        expected = 12 * h * z * x * (x @ g) / (EIGHT_PI * MU * distance**5)
        assert u[:2] == pytest.approx(expected[:2], rel=tolerance)


@both_blobs
def test_the_wall_attracts_a_pusher(blob):
    """u_z = -3 p/(64 pi mu h^2) at the middle of a force dipole p along the wall."""
    h, half, force = 80 * EPS, 0.5 * EPS, 0.6
    X = np.array([[half, 0.3, h], [-half, 0.3, h]])
    g = np.array([[force, 0.0, 0.0], [-force, 0.0, 0.0]])
    u, _ = at([0.0, 0.3, h], X, g, 0 * g, blob=blob)
    expected = -3 * (2 * half * force) / (64 * np.pi * MU * h**2)
    assert u[2] == pytest.approx(expected, rel=3e-4)  # (eps/h)^2 = 1.6e-4
