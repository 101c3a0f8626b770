"""``kind: curve``: splines, smoothing, frames, and the rods they make, against exact curves."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, make_smoothing_spline

from rodsim.analysis.topology import linking_number, writhe
from rodsim.case import load_case
from rodsim.errors import CaseError, FileError
from rodsim.forces.strain import strain_twist
from rodsim.scene.build import build_scene
from rodsim.scene.frames import plane_normal, smallest_rotations, transported
from rodsim.scene.smoothing import _System, smoothed, solve_banded
from rodsim.scene.spline import Spline

CASE = """
parameters: {{a: 1.4}}
fluid: {{viscosity: 1.3e-6, epsilon: 0.9}}
{plane}
rods:
  rod:
    shape: {{kind: curve, {shape}}}
    moduli: {{bending: 3e-3, twisting: 2e-3, shear: 0.7, stretch: 0.9}}
time: {{end: 0.5}}
"""
RNG = np.random.default_rng(11)


@pytest.fixture
def build(tmp_path):
    def make(shape, plane=""):
        (tmp_path / "case.yaml").write_text(CASE.format(shape=shape, plane=plane))
        return build_scene(load_case(tmp_path / "case.yaml"))

    return make


def parts(scene):
    return scene.initial.position.T, scene.initial.director.transpose(2, 0, 1)


def test_splines_are_scipys():
    u = np.sort(RNG.uniform(0, 6, 40))
    y = np.c_[np.sin(u), np.exp(-u)]
    x = np.linspace(u[0] - 0.1, u[-1] + 0.1, 300)
    ours = Spline(u, y)
    ends = [(1, ours.slope(u[0])), (1, ours.slope(u[-1]))]
    theirs = CubicSpline(u, y, bc_type=ends)
    assert abs(ours(x) - theirs(x)).max() < 1e-13
    assert abs(ours.slope(x) - theirs(x, 1)).max() < 1e-12
    y = np.c_[np.sin(u), np.cos(2 * u)]
    theirs = CubicSpline(np.append(u, u[0] + 7), np.r_[y, y[:1]], bc_type="periodic")
    assert abs(Spline(u, y, 7.0)(x) - theirs(x)).max() < 1e-13


@pytest.mark.parametrize("count", [2, 3, 4, 5])
def test_a_spline_through_few_points_is_their_polynomial(count):
    """Up to a cubic: four points have one, five need one to be given."""
    u = np.array([0.0, 0.7, 1.1, 2.5, 3.1])[:count]
    polynomial = np.polynomial.Polynomial([0.3, -1.2, 0.7, -0.4][: min(count, 4)])
    x = np.linspace(u[0], u[-1], 50)
    spline = Spline(u, polynomial(u)[:, None])
    assert spline(x)[:, 0] == pytest.approx(polynomial(x), abs=1e-14)
    assert spline.slope(x)[:, 0] == pytest.approx(polynomial.deriv()(x), abs=1e-13)


def test_smoothing_is_scipys_at_a_weight_and_keeps_its_distance():
    u = 0.1 * (np.arange(60) + RNG.uniform(0.0, 0.7, 60))
    y = np.c_[np.sin(u), np.exp(-u)] + 0.05 * RNG.normal(size=(60, 2))
    theirs = np.stack([make_smoothing_spline(u, row, lam=0.013)(u) for row in y.T], axis=1)
    assert abs(y - _System(u, y, None).change(0.013) - theirs).max() < 1e-12
    for period in (None, 6.3):
        moved = smoothed(u, y, 0.045, period) - y
        assert np.sqrt(np.mean(np.sum(moved**2, axis=1))) == pytest.approx(0.045, rel=1e-6)
    assert smoothed(u, y, 3.0) is None


def test_smoothing_brings_a_noisy_circle_nearer_to_the_circle():
    angle = 2 * np.pi * np.arange(200) / 200
    circle = 2.5 * np.c_[np.cos(angle), np.sin(angle)]
    noisy = circle + 0.03 * RNG.normal(size=circle.shape)
    found = smoothed(2.5 * angle, noisy, 0.03 * np.sqrt(2), 2.5 * 2 * np.pi)
    error, before = (np.sqrt(np.mean((x - circle) ** 2)) for x in (found, noisy))
    assert error < 0.3 * before


@pytest.mark.parametrize("count", [3, 4, 5, 6, 9, 31])
@pytest.mark.parametrize("cyclic", [True, False])
def test_banded_systems_against_dense_ones(count, cyclic):
    bands = [5 + RNG.random(count), RNG.random(count), 0.5 * RNG.random(count)]
    matrix = np.zeros((count, count))
    for shift, band in enumerate(bands):
        for i in range(count if cyclic else count - shift):
            j = (i + shift) % count
            matrix[i, j] += band[i]
            matrix[j, i] += band[i] * (shift > 0)
    target = RNG.normal(size=(count, 2))
    assert abs(matrix @ solve_banded(bands, target, cyclic) - target).max() < 1e-14


def test_smallest_rotations_turn_one_vector_into_the_other():
    before, after = (v / np.linalg.norm(v, axis=1)[:, None] for v in RNG.normal(size=(2, 9, 3)))
    turns = smallest_rotations(before, after)
    # a dozen roundings of numbers below 1; NumPy 1.26 and 2.4 sum in different orders
    assert abs(np.einsum("kab,kb->ka", turns, before) - after).max() < 3e-15
    axis = np.cross(before, after)
    assert abs(np.einsum("kab,kb->ka", turns, axis) - axis).max() < 3e-15


def test_frames_do_not_twist_but_by_their_turns():
    u = np.linspace(0, 7, 300)
    tangent = np.c_[np.cos(u), np.sin(u) * np.cos(0.3 * u), np.sin(0.3 * u) + 0.2]
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    open_frame = transported(tangent, np.array([0.3, 0.4, 0.5]))
    assert abs(strain_twist(open_frame, 0.1)[:, 2]).max() < 1e-12
    turned = transported(tangent, np.array([0.3, 0.4, 0.5]), turns=1.25)
    rate = 2 * np.pi * 1.25 / 299 / 0.1  # right-handed is positive
    assert strain_twist(turned, 0.1)[:, 2] == pytest.approx(rate, rel=1e-3)
    cone = np.c_[np.cos(u), np.sin(u), 0 * u + 0.7] / np.hypot(1, 0.7)
    assert abs(strain_twist(transported(cone, np.array([0, 0, 1.0])), 0.1)[:, 2]).max() < 1e-12


@pytest.mark.parametrize(
    ("points", "normal"),
    [
        (np.c_[np.zeros(9), RNG.normal(size=(9, 2))], [1, 0, 0]),
        (np.c_[RNG.normal(size=(9, 2)), np.zeros(9)] + 4.0, [0, 0, 1]),
        (np.outer(np.arange(5), [0, 0.3, 2]), [1, 0, 0]),
        (np.outer(np.arange(5), [0.7, 0, 0]), [0, 1, 0]),
    ],
)
def test_the_normal_of_the_plane_is_as_the_other_shapes_have_d1(points, normal):
    assert plane_normal(points) == pytest.approx(normal, abs=1e-12)


def helix(turns, per_turn):
    u = np.linspace(0, 2 * np.pi * turns, round(turns * per_turn) + 1)
    return np.c_[0.6 * np.cos(u), 0.6 * np.sin(u), 0.9 * u / (2 * np.pi)]


def helix_errors(scene, turns=3):
    stride = np.hypot(0.6, 0.9 / (2 * np.pi))
    X, D = parts(scene)
    angle = np.linspace(0, 2 * np.pi * turns, len(X))
    exact = np.c_[0.6 * np.cos(angle), 0.6 * np.sin(angle), 0.9 * angle / (2 * np.pi)]
    zero = 0 * angle
    tangent = np.c_[-0.6 * np.sin(angle), 0.6 * np.cos(angle), zero + 0.9 / (2 * np.pi)] / stride
    length = scene.rods.lengths[0] - 2 * np.pi * turns * stride
    return abs(X - exact).max(), abs(D[:, 2] - tangent).max(), abs(length)


def test_a_sampled_helix_becomes_the_helix_to_order_four(build, tmp_path):
    errors = []
    for per_turn in (16, 32, 64):
        np.savetxt(tmp_path / "h.csv", helix(3, per_turn), delimiter=",")
        errors.append(helix_errors(build("path: h.csv, points: 151")))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert (orders[:, [0, 2]] > 3.8).all()  # positions and length
    assert (orders[:, 1] > 2.8).all()  # tangents
    assert errors[-1][0] < 2e-7


def test_a_formula_is_the_curve_itself(build):
    position = '["0.6*cos(u)", "0.6*sin(u)", "0.9*u/(2*pi)"]'
    scene = build(f"position: {position}, from: 0, to: {6 * np.pi!r}, points: 151")
    found = helix_errors(scene)
    assert found[0] < 1e-11
    assert found[1] < 1e-9
    back = build(f"position: {position}, from: {6 * np.pi!r}, to: 0, points: 151")
    assert parts(back)[0][::-1] == pytest.approx(parts(scene)[0], abs=1e-11)


def test_parameters_and_numbers_in_a_formula(build):
    X, D = parts(build("position: [0, a, u**3], from: 0.5, to: 2, points: 21"))
    assert X[:, 1].tolist() == [1.4] * 21
    assert np.diff(X[:, 2]) == pytest.approx((2**3 - 0.5**3) / 20, rel=1e-12)
    assert D[7].tolist() == [[1, 0, 0], [0, 1, 0], [0, 0, 1]]


@pytest.mark.parametrize("turns", [0, 3, -2])
@pytest.mark.parametrize(
    "position",
    [
        '["2*cos(u)", "2*sin(u)", 0]',
        '["(2+0.6*cos(3*u))*cos(2*u)", "(2+0.6*cos(3*u))*sin(2*u)", "0.6*sin(3*u)"]',
        '["2*cos(u)", "1.5*sin(u)", "0.8*sin(2*u)"]',
    ],
)
def test_closed_curves_have_the_linking_number_they_are_given(build, position, turns):
    """Lk by Gauss's integral of the centreline and a curve beside it along D1."""
    shape = f"position: {position}, from: 0, to: {2 * np.pi!r}, closed: true, points: 240"
    scene = build(f"{shape}, turns: {turns}")
    X, D = parts(scene)
    wanted = round(writhe(X)) + turns
    assert linking_number(X, X + 1e-3 * D[:, 0]) == pytest.approx(wanted, abs=1e-9)
    strain = strain_twist(D, scene.rods.spacing[0], closed=True)[:, 2]
    rate = 2 * np.pi * (wanted - writhe(X)) / scene.rods.lengths[0]  # twist, spread evenly
    assert strain == pytest.approx(rate, abs=2e-3)  # also where the end meets the beginning


def test_a_closed_table_with_or_without_its_first_point_again(build, tmp_path):
    angle = 2 * np.pi * np.arange(41) / 40
    points = 1.7 * np.c_[np.cos(angle), np.sin(angle)]
    np.savetxt(tmp_path / "a.txt", points[:-1])
    np.savetxt(tmp_path / "b.txt", points)
    a, b = (build(f"path: {name}.txt, closed: true, points: 60") for name in "ab")
    assert np.array_equal(a.initial.position, b.initial.position)
    assert a.rods.lengths[0] == pytest.approx(2 * np.pi * 1.7, rel=1e-5)
    assert parts(a)[1][:, 0] == pytest.approx(np.repeat([[0, 0, 1]], 60, axis=0), abs=1e-12)


def test_a_table_in_another_unit(build, tmp_path):
    np.savetxt(tmp_path / "h.csv", 1e4 * helix(2, 30))  # the case is in um
    scene = build("path: h.csv, unit: Angstrom")
    np.savetxt(tmp_path / "h.csv", helix(2, 30))
    assert np.allclose(scene.initial.position, build("path: h.csv").initial.position, rtol=1e-12)
    assert "multiplied by 0.0001 to um" in str(scene.warnings[0])


def test_points_by_the_table_by_number_or_by_spacing(build, tmp_path):
    np.savetxt(tmp_path / "h.csv", helix(2, 30))
    length = 2 * 2 * np.pi * np.hypot(0.6, 0.9 / (2 * np.pi))
    assert build("path: h.csv").rods.count[0] == 61
    assert build("path: h.csv, points: 33").rods.count[0] == 33
    scene = build("path: h.csv, spacing: 0.05")
    assert scene.rods.count[0] == round(length / 0.05) + 1
    assert scene.rods.spacing[0] == 0.05
    scene = build(f"path: h.csv, points: 33, length: {1.1 * length}")
    assert scene.rods.spacing[0] == pytest.approx(1.1 * length / 32)
    assert "is 0.9091 times as long as the rod at rest" in str(scene.warnings[0])
    with pytest.raises(CaseError, match=r"is 0\.5 times as long .* as_is"):
        build(f"path: h.csv, points: 33, length: {2 * length}")


def test_a_curve_may_be_planar(build):
    scene = build(
        f'position: [0.3, "0.4*sin(2*u)", u], from: 0, to: {2 * np.pi!r}, points: 90', "plane: yz"
    )
    assert scene.planar
    assert not (scene.initial.director[0, 0] - 1.0).any()


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        ("path: t.txt, position: [u, 0, 0]", "give path or position, not both"),
        ("points: 5", "give path or position"),
        ("position: [u, 0, 0], points: 5, from: 1", "position needs from and to"),
        ("position: [u, 0, 0], points: 5, from: 1, to: 1", "from and to must differ"),
        ("position: [u, 0, 0], from: 1, to: 2", "position needs points, or spacing"),
        ("position: [u, 0, s], points: 5, from: 1, to: 2", "can use u, pi or a"),
        ("position: [u, 0, 0], points: 5, from: 1, to: 2, columns: [1, 2]", "only beside path"),
        ("path: t.txt, from: 3", "from: only beside position"),
        ("path: t.txt, length: 3, spacing: 1", "give length or spacing"),
        ("position: ['1/u', 0, 0], points: 9, from: -1, to: 1", "not finite at u = 0"),
        ("position: ['abs(u)', 0, 0], points: 9, from: -1, to: 1", "the curve turns back"),
        ("position: [1, 2, 3], points: 9, from: -1, to: 1", "stands still at u = -1"),
        ("position: ['cos(u)', 'sin(u)', 0], from: 0, to: 5, closed: true, points: 50",
         r"ends 1\.197 from where it begins"),
        ("path: ring.txt, closed: true, turns: 0.5", "must be a whole number on a closed curve"),
        ("path: ring.txt, closed: true, smoothing: 9", "nearer than that to a point"),
        ("path: twice.txt", r"point 4 \(line 5\) and point 5 \(line 6\) are the same"),
        ("path: blocks.txt", "has 2 blocks"),
        ("path: one.txt", "has 1 points: needs at least 2"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_curve_is_said(build, tmp_path, shape, words):
    angle = 2 * np.pi * np.arange(30) / 30
    points = np.c_[np.cos(angle), np.sin(angle)]
    np.savetxt(tmp_path / "ring.txt", points)
    np.savetxt(tmp_path / "twice.txt", np.insert(points, 5, points[4], axis=0))
    np.savetxt(tmp_path / "one.txt", points[:1])
    text = (tmp_path / "ring.txt").read_text().splitlines()
    (tmp_path / "blocks.txt").write_text("\n".join([*text, "", *text]))
    with pytest.raises(CaseError, match=words):
        build(shape)


def test_a_missing_table_is_a_file_error(build):
    with pytest.raises(FileError, match=r"case\.yaml:7: .*gone\.csv: no such file"):
        build("path: gone.csv")


def test_too_few_points_for_a_curve_are_warned_of(build):
    shape = "position: ['cos(u)', 'sin(u)', 0], from: 0, to: 3, points: 7"
    (warning,) = build(shape).warnings  # arcs of 0.5 rad: sin(0.25)/0.25
    assert "chords down to 0.9896 of the arcs" in str(warning)


def test_a_gap_and_a_curve_taken_as_open_are_warned_of(build, tmp_path):
    angle = 2 * np.pi * np.arange(60) / 60
    np.savetxt(tmp_path / "r.txt", np.c_[np.cos(angle), np.sin(angle)])
    (warning,) = build("path: r.txt").warnings
    assert "its ends are 1 median distances apart: closed: true joins them" in str(warning)
    np.savetxt(tmp_path / "half.txt", np.c_[np.cos(angle), np.sin(angle)][:31])
    words = " ".join(
        map(str, build("path: half.txt, closed: true, points: 300, as_is: false").warnings)
    )
    assert "19.1 times the median distance apart: a gap, two curves, or an open one taken" in words
