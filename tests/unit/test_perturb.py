"""A disturbed start: as large as asked, smooth, the same again, triads along what has moved."""

import numpy as np
import pytest
from scenes import load
from scipy.spatial.transform import Rotation

from rodsim.errors import CaseError
from rodsim.scene.build import build_scene

HOW = "{amplitude: 3.0e-3, seed: 5, modes: 6}"
RODS = {
    "closed_ring": ("ring", 200),
    "open_rod": ("rod", 76),
    "flagellum": ("tail", 600),
}


def states(config, how=HOW, *overrides):
    rod = RODS[config][0]
    plain = build_scene(load(config, *overrides))
    moved = build_scene(load(config, *overrides, f"rods.{rod}.perturb={how}"))
    return plain.initial, moved.initial, moved.rods


@pytest.mark.parametrize("config", RODS)
def test_as_large_as_asked_and_orthonormal(config):
    plain, moved, _ = states(config)
    rms = np.sqrt(np.mean(np.sum((moved.position - plain.position) ** 2, axis=0)))
    # The sum over points of an open rod counts its ends fully: 2 in 76 points.
    assert rms == pytest.approx(3e-3, rel=1e-12 if config == "closed_ring" else 0.05)
    D = moved.director.transpose(2, 0, 1)
    np.testing.assert_allclose(D @ D.transpose(0, 2, 1), np.eye(3)[None] + 0 * D, atol=4e-15)
    np.testing.assert_allclose(np.linalg.det(D), 1.0, atol=4e-15)


@pytest.mark.parametrize("config", ["closed_ring", "open_rod"])
def test_triads_follow_the_centreline_and_are_twisted(config):
    plain, moved, rods = states(config)
    M, ds = rods.points, rods.spacing[0]
    chord = (np.roll(moved.position, -1, axis=1) - np.roll(moved.position, 1, axis=1)) / (2 * ds)
    before = (np.roll(plain.position, -1, axis=1) - np.roll(plain.position, 1, axis=1)) / (2 * ds)
    inner = slice(0, M) if rods.closed[0] else slice(1, M - 1)

    def off(c, D):
        return np.linalg.norm((c - D[2] * (c * D[2]).sum(axis=0))[:, inner], axis=0).max()

    slope = np.linalg.norm(chord - before, axis=0)[inner].max()
    # Second order in the slope, or in the spacing over the shortest wave: below 1.5 % of it here.
    assert off(chord, moved.director) - off(before, plain.director) < 0.015 * slope
    # D1 and D2 first turn as D3 does, by the shortest way, then about it.
    axis = np.cross(plain.director[2], moved.director[2], axis=0)
    sine = np.maximum(np.linalg.norm(axis, axis=0), 1e-300)
    way = Rotation.from_rotvec((axis * np.arcsin(sine) / sine).T)
    first, second = (way.apply(plain.director[i].T).T for i in (0, 1))
    twist = np.arctan2(*((moved.director[0] * D).sum(axis=0) for D in (second, first)))
    asked = 2 * np.pi * 3e-3 / rods.lengths[0]
    # As above for the ends of an open rod.
    tolerance = 1e-9 if rods.closed[0] else 0.05
    assert np.sqrt(np.mean(twist**2)) == pytest.approx(asked, rel=tolerance)


def test_planar_stays_planar():
    plain, moved, _ = states("flagellum")
    assert np.array_equal(moved.position[0], plain.position[0])
    assert np.array_equal(moved.director[0], plain.director[0])
    assert abs(moved.position[1] - plain.position[1]).max() > 1e-3
    assert np.array_equal(moved.director[1:, 0], np.zeros_like(moved.director[1:, 0]))


def test_the_same_seed_is_the_same_curve_at_any_number_of_points():
    coarse = states("closed_ring", HOW, "rods.ring.shape.points=50")[1]
    fine = states("closed_ring")[1]
    np.testing.assert_allclose(coarse.position, fine.position[:, ::4], atol=4e-15)
    np.testing.assert_allclose(coarse.director, fine.director[:, :, ::4], atol=4e-15)
    other = states("closed_ring", HOW.replace("5", "6"))[1]
    assert abs(other.position - fine.position).max() > 1e-3


def test_a_closed_rod_has_no_seam():
    plain, moved, _ = states("closed_ring")
    shift = moved.position - plain.position
    step = np.linalg.norm(np.roll(shift, -1, axis=1) - shift, axis=0)
    # Half of the second difference of a sum of 6 modes over 200 points is below a per cent.
    assert step[-1] == pytest.approx(0.5 * (step[-2] + step[0]), rel=0.01)


def test_the_numbers_are_those_of_the_generator():
    from rodsim.scene.perturb import _coefficients

    class How:
        modes, seed = 1, 5

    # From numpy 2.4; each component of the displacement has a third of the mean square.
    bits = [
        0xCE14ABEEABB8E5A8,
        0xCED5352505CC99F5,
        0x83EC603F7806ADC0,
        0x492A477CA1570476,
        0x0DCE670AFAC210ED,
        0x622476854726028F,
        0x6891B332923923C4,
        0x0B9727B5218D35CE,
    ]
    value = np.array([(b >> 11) / 2**52 - 1 for b in bits]).reshape(4, 2).T
    scale = np.sqrt((value**2).sum(axis=0) / 2) * np.array([3, 3, 3, 1]) ** 0.5
    found = _coefficients(How, True, False)[:, :, 0]
    np.testing.assert_allclose(found, value / scale, rtol=1e-14)


@pytest.mark.parametrize(
    ("how", "reason"),
    [
        ("{amplitude: 0.1, modes: 101}", "modes = 101: 200 points show at most 100"),
        ("{amplitude: 3.0}", r"bends the rod by up to \d"),
        ("{amplitude: -1.0}", "rods.ring.perturb.amplitude"),
        ("{amplitude: 0.1, sead: 3}", "sead"),
    ],
)
def test_what_cannot_be_is_refused(how, reason):
    with pytest.raises(CaseError, match=reason):
        build_scene(load("closed_ring", f"rods.ring.perturb={how}"))
