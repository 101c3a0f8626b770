"""Strain twist of the shape itself, in expressions, and from tables over s and t."""

import numpy as np
import pytest

from rodsim.case import load_case
from rodsim.errors import CaseError, FileError
from rodsim.scene.build import build_scene
from rodsim.scene.system import RodSystem

CASE = """
parameters: {{k: 0.9, sigma: 37.0}}
fluid: {{viscosity: 1.3e-6, epsilon: 0.3}}
{plane}
rods:
  rod:
    shape: {shape}
    moduli: {{bending: [3e-3, 4e-3], twisting: 2e-3, shear: 0.7, stretch: 0.9}}
    strain_twist: {strain}
time: {{end: {end}}}
"""
SHAPES = [
    "{kind: straight, points: 30, length: 2.4, perturbation: 0.01}",
    "{kind: ring, radius: 1.7, points: 30, twist_perturbation: 0.7}",
    "{kind: helix, radius: 0.6, pitch: -0.9, points: 60, length: 5.0}",
    "{kind: sine, amplitude: 0.8, wavelength: 2.1, points: 90, length: 4.0}",
    "{kind: curve, position: [cos(u), sin(u), 0.3*u], from: 0, to: 6, points: 60, turns: 2.5}",
    "{kind: file, path: t.txt, spacing: 0.25, as_is: true}",
    "{kind: file, path: t.txt, spacing: 0.25, closed: true, as_is: true}",
]


def strain_twist(scene, t):
    """Strain twist (3, N) of a scene at a time."""
    return scene.parts[0].row(t).reshape(3, -1)


@pytest.fixture
def build(tmp_path):
    rng = np.random.default_rng(5)
    triads = np.linalg.qr(rng.normal(size=(9, 3, 3)))[0]
    triads *= np.sign(np.linalg.det(triads))[:, None, None]
    np.savetxt(tmp_path / "t.txt", np.c_[rng.normal(size=(9, 3)), triads.reshape(9, 9)])

    def make(shape, strain, plane="", end=0.5):
        text = CASE.format(shape=shape, strain=strain, plane=plane, end=end)
        (tmp_path / "case.yaml").write_text(text)
        return build_scene(load_case(tmp_path / "case.yaml"))

    return make


def energies(scene):
    seen = RodSystem(scene).observe(scene.initial)[1]
    return [float(seen[f"{kind}_energy"][0]) for kind in ("bending", "twisting")]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(
    "place", ["", ", rotate: {axis: [1, 2, 3], degrees: 33}, origin: [7, 8, 9]"]
)
def test_natural_is_free_of_bending_and_twist_as_it_is_built(build, shape, place):
    """Rounding of a strain is 1e-16/ds; its square times modulus and length bounds the energy."""
    scene = build(shape[:-1] + place + "}", "natural")
    assert sum(energies(scene)) < 1e-28 * scene.rods.lengths[0] / scene.rods.spacing[0] ** 2
    assert sum(energies(build(shape, "[0.1, 0, 0]"))) > 1e-6


def test_natural_of_a_planar_scene_stays_planar(build):
    scene = build("{kind: sine, amplitude: 2.0, wavelength: 7, points: 101, length: 20}", "natural",
                  plane="plane: yz")  # fmt: skip
    assert scene.planar
    assert not strain_twist(scene, 0.0)[1:].any()
    assert sum(energies(scene)) < 1e-25


def test_components_of_natural_in_expressions(build):
    shape = "{kind: helix, radius: 0.6, pitch: -0.9, points: 60, length: 5.0}"
    own = strain_twist(build(shape, "natural"), 0.0)
    strain = '["2*natural_1 + 0.3*sin(sigma*t + k*s)", natural_3, "natural_2 - 0.25"]'
    found = build(shape, strain)
    for t in (0.0, 0.013):
        s = (np.arange(59) + 0.5) * 5.0 / 59
        omega = strain_twist(found, t)[:, :59]
        assert omega[0] == pytest.approx(
            2 * own[0, :59] + 0.3 * np.sin(37 * t + 0.9 * s), rel=1e-12
        )
        assert omega[1] == pytest.approx(own[2, :59], rel=1e-13)
        assert omega[2] == pytest.approx(own[1, :59] - 0.25, rel=1e-13)
    assert found.parts.driven


def wave(s, t):
    return 0.8 * np.sin(0.9 * s - 37.0 * t) + 0.2 * np.cos(1.7 * s + 74.0 * t)


PERIOD = 2 * np.pi / 37.0
STRAIGHT = "{kind: straight, points: 61, length: 10}"


def save(path, s, t, values):
    rows = np.c_[s, values]
    np.savetxt(path, np.vstack([np.r_[0.0, t], rows]), delimiter=",")


def test_a_wave_in_a_table_is_the_wave_in_a_formula(build, tmp_path):
    """Cubic splines: order 4 in both steps. Also far beyond the first period."""
    worst = []
    for fine in (1, 2):
        s, t = np.linspace(0, 10, 40 * fine + 1), np.arange(24 * fine) * PERIOD / (24 * fine)
        save(tmp_path / "k.csv", s, t, wave(s[:, None], t))
        scene = build(STRAIGHT, f"[0, {{table: k.csv, period: {PERIOD!r}}}, 0]")
        assert scene.parts.driven
        middle = (np.arange(60) + 0.5) / 6
        times = np.linspace(0, 3.3 * PERIOD, 50)
        found = np.array([strain_twist(scene, time)[1, :60] for time in times])
        assert np.array_equal(
            found, scene.parts[0].row.at(times).reshape(len(times), 3, -1)[:, 1, :60]
        )
        worst.append(abs(found - wave(middle, times[:, None])).max())
    assert worst[1] < 1e-4
    assert np.log2(worst[0] / worst[1]) > 3.5


def test_a_table_over_s_alone(build, tmp_path):
    s = np.linspace(0, 10, 200)
    text = "s,kappa,other\n" + "".join(f"{x},{np.cos(0.7 * x)},3\n" for x in s)
    (tmp_path / "k.csv").write_text(text)
    scene = build(STRAIGHT, "[{table: k.csv, columns: [s, kappa]}, 0, 0.2]")
    middle = (np.arange(60) + 0.5) / 6
    assert not scene.parts.driven
    assert strain_twist(scene, 0.4)[0, :60] == pytest.approx(np.cos(0.7 * middle), abs=1e-7)
    assert strain_twist(scene, 0.4)[2, :60].tolist() == [0.2] * 60


@pytest.mark.parametrize(
    ("last_s", "last_t", "words"),
    [
        (10.0, 0.6, None),
        (9.8, 0.6, None),  # less than half a step beyond the last row
        (9.0, 0.6, "its s go from 0 to 9, the rod's segments from 0.0833333 to 9.91667"),
        (10.0, 0.4, "its times go from 0 to 0.4, the run from 0 to 0.5: give period"),
    ],
)
def test_a_table_must_reach_over_the_rod_and_the_run(build, tmp_path, last_s, last_t, words):
    s, t = np.linspace(0, last_s, 21), np.linspace(0, last_t, 9)
    save(tmp_path / "k.csv", s, t, np.zeros((21, 9)))
    if words is None:
        build(STRAIGHT, "[{table: k.csv}, 0, 0]")
        return
    with pytest.raises(CaseError, match=words) as error:
        build(STRAIGHT, "[{table: k.csv}, 0, 0]")
    assert "rods.rod.strain_twist.0" in str(error.value)


def test_what_is_wrong_with_strain_is_said_when_it_is_known(build, tmp_path):
    np.savetxt(tmp_path / "k.csv", np.c_[[0, 5, 10], [30.0, 30.0, 30.0]])
    with pytest.raises(CaseError, match=r"abs\(Omega\) ds = 5 at .* no rest state"):
        build(STRAIGHT, "[{table: k.csv}, 0, 0]")
    with pytest.raises(CaseError, match="is not finite at s = "):
        build(STRAIGHT, "[log(natural_1 - 1), 0, 0]")
    with pytest.raises(FileError, match=r"rods\.rod\.strain_twist.*gone\.csv: no such file"):
        build(STRAIGHT, "[{table: gone.csv}, 0, 0]")
    with pytest.raises(CaseError, match="must be natural"):
        build(STRAIGHT, "naturel")
    with pytest.raises(CaseError, match="'natural_1' already has a meaning"):
        load_case(tmp_path / "case.yaml", ["parameters={natural_1: 3}"])
