"""Analysis functions against curves whose numbers are known."""

import numpy as np
import pytest

from rodsim.analysis.curve import (
    curvature,
    misalignment,
    radius_of_gyration,
    stretch,
    torsion,
)
from rodsim.analysis.topology import linking_number, twist, writhe
from rodsim.errors import UsageError
from rodsim.scene.shapes import rotation_matrix

TURN = rotation_matrix((0.3, -0.8, 0.5), 1.1)


def torus_knot(p, q, points, big=2.3, small=0.7):
    """A curve that goes p times round the axis of a torus and q times through its hole."""
    t = 2 * np.pi * np.arange(points) / points
    radius = big + small * np.cos(q * t)
    curve = np.array([radius * np.cos(p * t), radius * np.sin(p * t), small * np.sin(q * t)])
    return (TURN @ curve).T + 1.7


def ribbon(points, turns, wave=0.0):
    """A closed curve near a circle, bent out of its plane by ``wave``, D^1 turning ``turns``."""
    t = 2 * np.pi * np.arange(points) / points
    radius = 2.3 + wave * np.cos(2 * t)
    X = np.array([radius * np.cos(t), radius * np.sin(t), wave * np.sin(2 * t + 0.4)]).T
    tangent = np.roll(X, -1, axis=0) - np.roll(X, 1, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    across = np.cross([0.0, 0.0, 1.0], tangent)
    across /= np.linalg.norm(across, axis=1)[:, None]
    up = np.cross(tangent, across)
    angle = turns * t
    first = np.cos(angle)[:, None] * up - np.sin(angle)[:, None] * across
    return X, np.stack([first, np.cross(tangent, first), tangent], axis=1)


def gauss_integral(first, second_or_none=None):
    """Writhe or link by the plain double sum over midpoints: an obvious, slow twin, order 2."""
    total = 0.0
    second = first if second_or_none is None else second_or_none
    a, da = 0.5 * (first + np.roll(first, -1, 0)), np.roll(first, -1, 0) - first
    b, db = 0.5 * (second + np.roll(second, -1, 0)), np.roll(second, -1, 0) - second
    for i in range(len(a)):
        for j in range(len(b)):
            r = a[i] - b[j]
            if r.any():
                total += np.dot(np.cross(da[i], db[j]), r) / np.dot(r, r) ** 1.5
    return total / (4 * np.pi)


def test_a_plane_curve_has_no_writhe():
    X, _ = ribbon(60, 0)
    assert writhe(X @ TURN.T) == pytest.approx(0.0, abs=1e-12)


def test_writhe_is_gauss_integral_and_changes_sign_in_the_mirror():
    knot = torus_knot(2, 3, 100)
    exact = writhe(torus_knot(2, 3, 600))
    assert writhe(knot) == pytest.approx(exact, rel=1e-3)  # order 2 in the edges: 6e-4 seen
    assert gauss_integral(knot) == pytest.approx(exact, rel=1e-2)  # that of the midpoints
    assert writhe(knot * [1, 1, -1]) == pytest.approx(-writhe(knot), rel=1e-12)
    assert writhe(knot @ TURN.T * 3.3) == pytest.approx(writhe(knot), rel=1e-10)


def test_right_handed_coils_have_positive_writhe():
    """An open right-handed helix of n turns: Wr -> n (1 - sin(pitch angle)) (Fuller 1971)."""
    turns, radius, rise = 12, 0.9, 0.35
    t = 2 * np.pi * np.arange(turns * 60 + 1) / 60
    X = np.array([radius * np.cos(t), radius * np.sin(t), rise * t]).T
    expected = turns * (1 - rise / np.hypot(radius, rise))
    # Ends: Wr of an open curve differs by less than one; the slope over turns has no such error.
    half = X[: turns * 30 + 1]
    assert writhe(X, False) - writhe(half, False) == pytest.approx(expected / 2, rel=5e-3)


@pytest.mark.parametrize(("p", "q"), [(1, 3), (1, -4)])
def test_linking_number_of_a_torus_winding_and_its_core(p, q):
    curve = torus_knot(p, q, 90)
    core = torus_knot(1, 0, 70, small=0.0)
    assert abs(linking_number(curve, core)) == pytest.approx(abs(q), abs=1e-9)
    assert np.sign(linking_number(curve, core)) == -np.sign(q)  # y(t) is clockwise seen along t
    assert linking_number(core, curve) == pytest.approx(linking_number(curve, core), abs=1e-9)
    assert linking_number(curve, core + 40.0) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("turns", [0, 3, -2])
@pytest.mark.parametrize("wave", [0.0, 0.4])
def test_link_is_twist_plus_writhe_and_whole(turns, wave):
    X, D = ribbon(120, turns, wave)
    link = linking_number(X, X + 0.01 * D[:, 0])
    assert link == pytest.approx(turns, abs=1e-8)
    assert twist(X, D) + writhe(X) == pytest.approx(turns, abs=1e-10)
    if wave:
        assert abs(writhe(X)) > 1e-3  # so that it is no plane curve


def test_curvature_and_torsion_of_a_helix():
    """kappa = r/(r^2 + p^2), tau = p/(r^2 + p^2), both to order 2 in the step."""
    radius, rise, errors = 0.9, -0.35, []
    square = radius**2 + rise**2
    for points in (60, 120):
        t = np.linspace(0.2, 7.7, points)
        X = np.array([radius * np.cos(t), radius * np.sin(t), rise * t]).T @ TURN.T
        kappa, tau = curvature(X), torsion(X)
        assert kappa.shape == (points - 2,)
        assert tau.shape == (points - 3,)
        errors.append([abs(kappa * square / radius - 1).max(), abs(tau * square / rise - 1).max()])
    assert np.log2(np.array(errors[0]) / errors[1]) == pytest.approx([2, 2], abs=0.1)
    assert max(errors[1]) < 2e-3


def test_curvature_of_a_closed_circle_is_exact():
    X, _ = ribbon(17, 0)
    assert curvature(X, closed=True) == pytest.approx(np.full(17, 1 / 2.3), rel=1e-12)
    assert torsion(X, closed=True) == pytest.approx(np.zeros(17), abs=1e-12)


def test_radius_of_gyration_of_a_rod_and_a_ring():
    line = np.outer(np.linspace(0, 3.1, 2001), [0.48, 0.6, 0.64])
    assert radius_of_gyration(line) == pytest.approx(3.1 / np.sqrt(12), rel=1e-3)
    X, _ = ribbon(40, 0)
    assert radius_of_gyration(X + 5.0) == pytest.approx(2.3, rel=1e-12)


def test_stretch_and_misalignment_see_what_was_put_in():
    X, D = ribbon(50, 0)
    chord = 2 * 2.3 * np.sin(np.pi / 50)
    assert stretch(X * 1.02, chord, True) == pytest.approx(np.full(50, 0.02), rel=1e-9)
    assert misalignment(X, D, True) == pytest.approx(np.zeros(50), abs=1e-7)
    line = np.outer(np.arange(9), [0.0, 0.0, 0.3])
    tilted = np.tile(rotation_matrix((1, 0, 0), 0.07).T, (9, 1, 1))
    assert misalignment(line, tilted) == pytest.approx(np.full(8, 0.07), rel=1e-9)


def test_a_curve_needs_three_points():
    with pytest.raises(UsageError, match="M >= 3"):
        writhe(np.zeros((2, 3)))
