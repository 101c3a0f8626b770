import numpy as np
import pytest

from rodsim.case import load_case
from rodsim.scene.build import build_scene
from rodsim.scene.system import RodSystem

CASE = """
fluid: {{viscosity: 1.3e-6, epsilon: 0.2}}
rods:
  rod:
    shape: {shape}
    moduli: {{bending: 3e-3, twisting: 2e-3, shear: 0.7, stretch: 0.9}}
time: {{end: 0.5}}
"""


@pytest.fixture
def build(tmp_path):
    def make(shape):
        path = tmp_path / "case.yaml"
        path.write_text(CASE.format(shape=shape))
        return build_scene(load_case(path))

    return make


def triads_are_orthonormal(D):
    gram = np.einsum("ick,jck->ijk", D, D)
    right_handed = np.linalg.det(D.transpose(2, 0, 1))
    return abs(gram - np.eye(3)[:, :, None]).max() < 1e-14 and np.allclose(right_handed, 1.0)


def test_straight_rod_of_the_paper(build):
    scene = build("{kind: straight, points: 5, spacing: 0.3, perturbation: 0.02}")
    X, D = scene.initial.position, scene.initial.director
    assert X[2] == pytest.approx([0, 0.306, 0.612, 0.918, 1.224])  # (40): (1 + xi) s
    assert not X[:2].any()
    assert D[2, :, 3] == pytest.approx([0, np.sin(0.02), np.cos(0.02)])  # (43)
    assert triads_are_orthonormal(D)
    assert scene.rods.spacing == pytest.approx([0.3])


def test_straight_rod_by_its_length(build):
    scene = build("{kind: straight, points: 5, length: 2.4}")
    assert scene.rods.spacing == pytest.approx([0.6])
    assert scene.length_scale == pytest.approx(2.4)


def test_ring_of_the_paper(build):
    scene = build("{kind: ring, radius: 1.7, points: 8, twist_perturbation: 0.4}")
    X, D = scene.initial.position, scene.initial.director
    assert X[:, 2] == pytest.approx([0, 1.7, 0], abs=1e-15)
    angle = 0.4  # xi sin(pi/2) at the third point, where r = y
    assert D[0, :, 2] == pytest.approx([0, np.sin(angle), np.cos(angle)], abs=1e-15)  # (47)
    assert D[1, :, 2] == pytest.approx([0, np.cos(angle), -np.sin(angle)], abs=1e-15)  # (48)
    assert D[2, :, 2] == pytest.approx([-1, 0, 0], abs=1e-15)  # (49)
    assert triads_are_orthonormal(D)
    assert scene.rods.spacing == pytest.approx([2 * np.pi * 1.7 / 8])
    assert scene.rods.closed.tolist() == [True]


@pytest.mark.parametrize("pitch", [0.9, -0.9])
def test_helix_has_its_radius_pitch_handedness_and_arc_steps(build, pitch):
    scene = build(f"{{kind: helix, radius: 0.6, pitch: {pitch}, points: 201, length: 8.0}}")
    X, D = scene.initial.position, scene.initial.director
    assert np.hypot(X[0], X[1]) == pytest.approx(0.6)
    angle = np.unwrap(np.arctan2(X[1], X[0]))
    assert X[2, 1:] / angle[1:] == pytest.approx(pitch / (2 * np.pi))
    chord = np.linalg.norm(np.diff(X, axis=1), axis=0)
    assert chord == pytest.approx(chord[0])
    assert chord[0] == pytest.approx(0.04, rel=1e-3)  # arc 8/200, chord shorter by (kappa ds)^2/24
    assert triads_are_orthonormal(D)
    tangent = np.gradient(X, axis=1)
    cosines = np.sum(D[2] * tangent, axis=0) / np.linalg.norm(tangent, axis=0)
    assert cosines[1:-1] == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("pitch", [1.7, -1.7])
def test_a_tapered_helix_starts_on_its_axis(build, pitch):
    """Its radius and handedness by formula, its arc length by the trapezoidal rule."""
    shape = f"{{kind: helix, radius: 0.6, pitch: {pitch}, points: 201, length: 8.0, taper: 0.9}}"
    X, D = (scene := build(shape)).initial.position, scene.initial.director
    z = abs(X[2])
    assert X[:, 0].tolist() == [0.0, 0.0, 0.0]
    assert D[2, :, 0] == pytest.approx([0, 0, np.sign(pitch)])
    assert np.hypot(X[0], X[1]) == pytest.approx(0.6 * (1 - np.exp(-((z / 0.9) ** 2))), abs=1e-14)
    angle = np.unwrap(np.arctan2(X[1], X[0])[1:])
    assert X[2, 1:] / angle == pytest.approx(pitch / (2 * np.pi))
    dense = np.linspace(0.0, z[-1], 1_000_001)
    radius, phase = 0.6 * (1 - np.exp(-((dense / 0.9) ** 2))), 2 * np.pi * dense / 1.7
    curve = np.array([radius * np.cos(phase), radius * np.sin(phase), dense])
    arc = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(curve, axis=1), axis=0)))
    assert np.interp(z, dense, arc) == pytest.approx(np.arange(201) * 0.04, abs=1e-9)
    assert triads_are_orthonormal(D)
    tangent = np.gradient(X, axis=1)
    cosines = np.sum(D[2] * tangent, axis=0) / np.linalg.norm(tangent, axis=0)
    assert cosines[1:-1] == pytest.approx(1.0, abs=1e-4)


def test_far_from_its_start_a_tapered_helix_is_the_plain_one(build):
    """There its triads turn as steadily as those: strain twist (curvature, 0, torsion)."""
    case = "{kind: helix, radius: 0.6, pitch: 1.7, points: 401, length: 8.0%s}"
    tapered, plain = (build(case % more).initial for more in (", taper: 0.3", ""))
    turn = [s.director[:, :, -1] @ s.director[:, :, -2].T for s in (tapered, plain)]
    assert turn[0] == pytest.approx(turn[1], abs=1e-10)
    assert np.hypot(*tapered.position[:2, -1]) == pytest.approx(0.6)


def test_sine_has_equal_arc_steps_in_its_plane(build):
    scene = build(
        "{kind: sine, amplitude: 0.8, wavelength: 2.1, phase: 0.6, points: 401, length: 9.0}"
    )
    X, D = scene.initial.position, scene.initial.director
    assert not X[0].any()
    assert X[1] == pytest.approx(0.8 * np.sin(2 * np.pi * X[2] / 2.1 + 0.6), abs=1e-13)
    # Arc length by the trapezoidal rule on 2 million points, independent of the quadrature used.
    z = np.linspace(0.0, X[2, -1], 2_000_001)
    slope = 0.8 * 2 * np.pi / 2.1 * np.cos(2 * np.pi * z / 2.1 + 0.6)
    arc = np.concatenate([[0], np.cumsum(np.hypot(1, 0.5 * (slope[1:] + slope[:-1])))]) * z[1]
    assert np.interp(X[2], z, arc) == pytest.approx(np.arange(401) * 9.0 / 400, abs=1e-9)
    assert np.array_equal(D[0], np.array([[1.0], [0.0], [0.0]]).repeat(401, axis=1))
    assert triads_are_orthonormal(D)


@pytest.mark.parametrize(
    "shape",
    [
        "{kind: straight, points: 30, length: 2.4, perturbation: 0.01}",
        "{kind: ring, radius: 1.7, points: 30, twist_perturbation: 0.7}",
        "{kind: helix, radius: 0.6, pitch: -0.9, points: 30, length: 5.0}",
        "{kind: helix, radius: 0.6, pitch: 1.7, points: 40, length: 5.0, taper: 0.9}",
        "{kind: sine, amplitude: 0.8, wavelength: 2.1, points: 30, length: 4.0}",
        "{kind: file, path: rod.txt, spacing: 0.25, as_is: true}",
        "{kind: file, path: rod.txt, spacing: 0.25, closed: true, as_is: true}",
    ],
)
def test_no_shape_has_a_net_force_or_torque(build, tmp_path, shape):
    rng = np.random.default_rng(5)
    triads = np.linalg.qr(rng.normal(size=(9, 3, 3)))[0]
    triads *= np.sign(np.linalg.det(triads))[:, None, None]
    rows = np.column_stack([rng.normal(size=(9, 3)), triads.reshape(9, 9)])
    np.savetxt(tmp_path / "rod.txt", rows)
    system = RodSystem(build(shape))
    fields, seen = system.observe(system.scene.initial)
    size = abs(fields["force"]).sum() + abs(fields["torque"]).sum()
    assert seen["net_force"] == pytest.approx(0.0, abs=1e-15 * size)
    assert seen["net_torque"] == pytest.approx(0.0, abs=1e-14 * size)


def test_rotate_comes_before_origin(build):
    scene = build(
        "{kind: straight, points: 3, length: 2.0, rotate: {axis: [0, 3, 0], degrees: 90},"
        " origin: [5, 6, 7]}"
    )
    assert scene.initial.position.T.tolist() == [[5, 6, 7], [6, 6, 7], [7, 6, 7]]
    assert scene.initial.director[2, :, 0].tolist() == [1, 0, 0]
    assert scene.initial.director[0, :, 0].tolist() == [0, 0, -1]


def test_table_of_a_rod_that_starts_stretched(build, tmp_path):
    rows = [[0, 0, 0.5 * k, *np.eye(3).ravel()] for k in range(4)]
    np.savetxt(tmp_path / "rod.txt", rows, header="x y z D1 D2 D3")
    scene = build("{kind: file, path: rod.txt, spacing: 0.25, as_is: true}")
    assert scene.initial.position[2].tolist() == [0, 0.5, 1.0, 1.5]
    assert scene.rods.spacing.tolist() == [0.25]
    assert scene.rods.closed.tolist() == [False]
