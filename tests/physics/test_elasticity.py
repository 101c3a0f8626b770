"""Loads and energies of the rod: against a twin, the energy's own gradient, and the invariants."""

import numpy as np
import pytest
import twins

from rodsim.compiled.rotations import rotate
from rodsim.forces.elasticity import UNIFORM, energies, first_half_turn, point_loads, segment_strain
from rodsim.nodes import lay_out
from rodsim.scene.shapes import rotation_matrix

MODULI = np.array([3.1e-3, 4.7e-3, 2.3e-3, 0.83, 0.71, 1.3])  # nothing equal, nothing 1


def table(*kinds):
    """Rods from (count, closed, ds)."""
    return lay_out((f"rod{i}", *kind, MODULI) for i, kind in enumerate(kinds))


def bent(points, length=5.3, seed=2, noise=0.0):
    """A smooth space curve with smoothly turning triads, sampled at ``points``; (X, D, ds)."""
    s = np.linspace(0.0, length, points)
    rng = np.random.default_rng(seed)
    X = np.array([0.7 * np.sin(0.9 * s), 0.4 * np.cos(1.3 * s), 0.8 * s])
    theta = np.array([0.6 * np.sin(0.7 * s + 0.2), 0.5 * np.cos(0.9 * s), 0.4 * s])
    X, theta = X + noise * rng.normal(size=X.shape), theta + noise * rng.normal(size=X.shape)
    start = np.repeat(rotation_matrix((0.2, 1.1, -0.4), 0.9).T[:, :, None], points, axis=2)
    D = np.empty((3, 3, points))
    rotate(np.ascontiguousarray(theta), np.ascontiguousarray(start), D)
    return np.ascontiguousarray(X), D, length / (points - 1)


def loads_of(X, D, omega, rods):
    loads = np.zeros((6, rods.points))
    point_loads(X, D, omega, rods.tables, loads)
    return loads


def energy_of(X, D, omega, rods):
    split, length = np.empty((4, len(rods.names))), np.empty(len(rods.names))
    energies(X, D, omega, rods.tables, UNIFORM, split, length)
    return split


def strain_twist(points, seed=3):
    return np.random.default_rng(seed).normal(size=(3, points))


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("points", [3, 11])
def test_loads_equal_their_twin(closed, points):
    X, D, ds = bent(points, noise=0.1)
    omega = strain_twist(points)
    loads = loads_of(X, D, omega, table((points, closed, ds)))
    g, m = twins.rod_loads(X.T, D.transpose(2, 0, 1), omega.T, ds, MODULI, closed)
    # The twin's matrix logarithm is good to about 1e-13.
    assert pytest.approx(g, abs=1e-11 * abs(g).max()) == loads[:3].T
    assert pytest.approx(m, abs=1e-11 * abs(m).max()) == loads[3:].T


@pytest.mark.parametrize("closed", [False, True])
def test_force_is_the_gradient_of_the_energy(closed):
    """g_k = -dE/dX_k exactly, at any spacing: F does not depend on X through the triads."""
    X, D, ds = bent(7, noise=0.1)
    omega, rods = strain_twist(7), table((7, closed, ds))
    g = loads_of(X, D, omega, rods)[:3]
    h = 1e-6
    for c in range(3):
        for k in range(7):
            up, down = X.copy(), X.copy()
            up[c, k] += h
            down[c, k] -= h
            slope = energy_of(up, D, omega, rods) - energy_of(down, D, omega, rods)
            # E is quadratic in X: the central difference is exact, rounding is 1e-16 E/h.
            assert g[c, k] == pytest.approx(-slope.sum() / (2 * h), abs=1e-8 * abs(g).max())


def torque_mismatch(points):
    """Largest difference of m from -dE/d(rotation) at inner points, relative to the torque."""
    X, D, ds = bent(points)
    rods, omega = table((points, False, ds)), np.zeros((3, points))
    m = loads_of(X, D, omega, rods)[3:]
    h, worst = 1e-5, 0.0
    for k in range(1, points - 1, points // 5):
        for c in range(3):
            total = []
            for sign in (1, -1):
                theta = np.zeros((3, points))
                theta[c, k] = sign * h
                turned = np.empty_like(D)
                rotate(theta, D, turned)
                total.append(energy_of(X, turned, omega, rods).sum())
            worst = max(worst, abs(m[c, k] + (total[0] - total[1]) / (2 * h)))
    return worst / abs(m[:, 1:-1]).max()


def test_torque_is_the_gradient_of_the_energy_to_second_order():
    """(31) is the balance of moments of the continuous rod: it shares the cross product F x X'
    between the two ends of a segment and takes N at the middle, where the gradient of the discrete
    energy has terms of order (theta ds)^2 more. Halving ds divides the difference by four."""
    coarse, fine = torque_mismatch(41), torque_mismatch(81)
    assert 0.0 < fine < coarse < 0.05
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.25)


@pytest.mark.parametrize("closed", [False, True])
def test_net_force_and_torque_vanish(closed):
    X, D, ds = bent(33, noise=0.2)
    loads = loads_of(X, D, strain_twist(33), table((33, closed, ds)))
    g, m = loads[:3], loads[3:]
    size = abs(loads).sum()
    assert g.sum(axis=1) == pytest.approx(0.0, abs=1e-15 * size)
    moments = np.cross(X, g, axis=0) + m
    assert moments.sum(axis=1) == pytest.approx(0.0, abs=1e-14 * size * abs(X).max())


def test_several_rods_are_as_alone():
    """Rods of one array do not touch each other, whatever is open or closed."""
    parts = [bent(points, seed=seed, noise=0.1) for seed, points in enumerate((6, 9, 4))]
    kinds = [(6, True, parts[0][2]), (9, False, parts[1][2]), (4, True, parts[2][2])]
    omegas = [strain_twist(kind[0], seed=i) for i, kind in enumerate(kinds)]
    X, D, omega = (
        np.ascontiguousarray(np.concatenate(arrays, axis=-1))
        for arrays in ([p[0] for p in parts], [p[1] for p in parts], omegas)
    )
    together, rods = loads_of(X, D, omega, table(*kinds)), table(*kinds)
    split = energy_of(X, D, omega, rods)
    for r, (kind, own) in enumerate(zip(kinds, omegas, strict=True)):
        nodes = slice(rods.first[r], rods.first[r] + rods.count[r])
        alone = table(kind)
        assert np.array_equal(together[:, nodes], loads_of(*parts[r][:2], own, alone))
        assert np.array_equal(split[:, [r]], energy_of(*parts[r][:2], own, alone))


@pytest.mark.parametrize("closed", [False, True])
def test_turned_moved_mirrored_and_reversed_rods(closed):
    """Rigid motion turns the loads; s -> L - s and the mirror (Omega_3 -> -Omega_3) keep E."""
    X, D, ds = bent(12, noise=0.1)
    omega, rods = strain_twist(12), table((12, closed, ds))
    loads, split = loads_of(X, D, omega, rods), energy_of(X, D, omega, rods)
    turn = rotation_matrix((0.5, -0.3, 1.9), 2.1)
    turned = np.einsum("ab,ibk->iak", turn, D)
    moved = loads_of(turn @ X + np.array([[3.0], [-2.0], [5.0]]), turned, omega, rods)
    for rows in (slice(0, 3), slice(3, 6)):
        size = abs(loads[rows]).max()
        assert moved[rows] == pytest.approx(turn @ loads[rows], abs=1e-12 * size)
    # Reversed: points in the other order, D1 kept, D2 and D3 turned round.
    flip = np.array([1.0, -1.0, -1.0])
    back_omega = np.zeros_like(omega)
    segments = 12 if closed else 11
    back_omega[:, :segments] = (omega[:, :segments] * np.array([[-1.0], [1.0], [1.0]]))[:, ::-1]
    if closed:  # the segment after the reversed point k is the one before the point itself
        back_omega = np.roll(back_omega, -1, axis=1)
    back = energy_of(
        np.ascontiguousarray(X[:, ::-1]),
        np.ascontiguousarray((D * flip[:, None, None])[:, :, ::-1]),
        np.ascontiguousarray(back_omega),
        rods,
    )
    assert back == pytest.approx(split, rel=1e-11)
    # Mirror x -> -x: vectors are reflected, and D1 turned round to stay right-handed.
    mirror = np.array([-1.0, 1.0, 1.0])
    image = D * mirror[None, :, None] * np.array([-1.0, 1.0, 1.0])[:, None, None]
    reflected = energy_of(
        np.ascontiguousarray(X * mirror[:, None]),
        np.ascontiguousarray(image),
        np.ascontiguousarray(omega * np.array([[1.0], [-1.0], [-1.0]])),
        rods,
    )
    assert reflected == pytest.approx(split, rel=1e-11)


def test_at_rest_every_load_is_zero():
    """A straight rod, a uniformly turned helix: no 0/0 where neighbours are alike."""
    points, ds = 9, 0.25  # a power of two: the differences of the positions are exact
    X = np.zeros((3, points))
    X[2] = ds * np.arange(points)
    D = np.ascontiguousarray(np.repeat(np.eye(3)[:, :, None], points, axis=2))
    loads = loads_of(X, D, np.zeros((3, points)), table((points, False, ds)))
    assert np.array_equal(loads, np.zeros((6, points)))


def test_strain_of_a_known_rotation():
    """Triads turned by theta about e: strain 2 sin(theta/2)/ds e^i, half triad by theta/2."""
    axis, theta, ds = np.array([0.36, -0.48, 0.8]), 2.9, 0.17
    D = np.empty((3, 3, 2))
    D[:, :, 0] = rotation_matrix((1.0, 0.4, 0.2), 0.8).T
    D[:, :, 1] = D[:, :, 0] @ rotation_matrix(axis, theta).T
    X = np.array([[0.1, 0.3], [0.2, -0.2], [0.4, 0.9]])
    strain, half = np.empty(6), np.empty((3, 3))
    segment_strain(X, D, 0, 1, ds, strain, half)
    expected = D[:, :, 0] @ rotation_matrix(axis, 0.5 * theta).T
    # Near a half-turn cos(theta/2) = 0.12 costs one to two digits.
    assert half == pytest.approx(expected, abs=1e-13)
    assert strain[:3] == pytest.approx(2 * np.sin(theta / 2) / ds * D[:, :, 0] @ axis, rel=1e-13)
    assert strain[3:] == pytest.approx(expected @ (X[:, 1] - X[:, 0]) / ds - [0, 0, 1], rel=1e-12)


def test_a_half_turn_is_found_and_shows_as_nan():
    D = np.ascontiguousarray(np.repeat(np.eye(3)[:, :, None], 5, axis=2))
    D[1:, :, 3:] *= -1.0
    X = np.zeros((3, 5))
    X[2] = 0.3 * np.arange(5)
    rods = table((5, False, 0.3))
    assert first_half_turn(D, rods.tables) == 2
    loads = loads_of(X, D, np.zeros((3, 5)), rods)
    assert np.isnan(loads[:, 2:4]).all()
    assert np.isfinite(loads[:, [0, 1, 4]]).all()


def test_energies_of_a_known_state():
    """Stretched by 1 + e and sheared along D1: E = 1/2 L (b3 e^2 + b1 g^2); twist a3 q^2 L/2."""
    points, ds, stretch, shear, twist = 21, 0.11, 0.07, -0.04, 0.9
    s = ds * np.arange(points)
    angle = 2 * np.arcsin(0.5 * twist * ds)  # the discrete strain is 2 sin(theta/2)/ds
    turn = angle * np.arange(points)
    X = np.array([0 * s, 0 * s, (1 + stretch) * s])
    D = np.array([[np.cos(turn), np.sin(turn), 0 * s], [-np.sin(turn), np.cos(turn), 0 * s],
                  [0 * s, 0 * s, 1 + 0 * s]])  # fmt: skip
    omega = np.zeros((3, points))
    split = energy_of(X, D, omega, table((points, False, ds)))[:, 0]
    length, (_, _, a3, b1, _, b3) = ds * (points - 1), MODULI
    assert split == pytest.approx(
        [0.0, 0.5 * a3 * twist**2 * length, 0.0, 0.5 * b3 * stretch**2 * length], rel=1e-11
    )
    tilted = np.ascontiguousarray(np.repeat(np.eye(3)[:, :, None], points, axis=2))
    X[0] = shear * s
    split = energy_of(X, tilted, omega, table((points, False, ds)))[:, 0]
    assert split[2] == pytest.approx(0.5 * b1 * shear**2 * length, rel=1e-12)
