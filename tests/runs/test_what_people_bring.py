"""Nine situations of people who do this work, each as a case of a few lines, with right numbers.

7, a sweep from a relaxed state that is relaxed again, is in test_inputs.py; 8, starts from outputs
with other units, spacings, or diverged, in test_data.py.
"""

import numpy as np
import pytest
from calls import call

from rodsim.analysis.topology import twist, writhe
from rodsim.case import load_case
from rodsim.forces.elastic import ENERGIES
from rodsim.run.forecast import forecast
from rodsim.run.machine import Machine
from rodsim.scene.build import build_scene
from rodsim.scene.system import RodSystem

CASE = """
units: {{length: {unit}, mass: g, time: s}}
fluid: {{viscosity: 1.3e-6, epsilon: 0.5}}
rods:
  one:
    shape: {shape}
    moduli: {{bending: {bending}, twisting: 2.0e-3, shear: 0.7, stretch: 0.9}}
    strain_twist: {strain}
time: {{end: 1.0e-3}}
"""


@pytest.fixture
def build(tmp_path):
    def make(shape, strain="[0, 0, 0]", bending="3.0e-3", unit="um"):
        path = tmp_path / "case.yaml"
        path.write_text(CASE.format(shape=shape, strain=strain, bending=bending, unit=unit))
        return build_scene(load_case(path))

    return make


def energies(scene):
    """Return bending, twisting, shear and stretch energy at t = 0."""
    seen = RodSystem(scene).observe(scene.initial)[1]
    return np.array([seen[name][0] for name in ENERGIES])


def written(path, table, head=""):
    rows = "\n".join(" ".join(map(repr, row)) for row in np.asarray(table).tolist())
    path.write_text(f"{head}{rows}\n")


def test_1_a_ring_with_triads_from_another_program(build, tmp_path):
    """Radius R, n turns: bending a pi/R, twisting a3 pi n^2/R; another rod is in the same file."""
    count, radius, turns = 300, 2.5, 5
    angle = 2 * np.pi * np.arange(count) / count
    zero = 0.0 * angle
    out, up = np.array([np.cos(angle), np.sin(angle), zero]).T, np.array([0.0, 0.0, 1.0])
    about = (turns * angle)[:, None]
    first = np.cos(about) * up + np.sin(about) * out
    third = np.array([-np.sin(angle), np.cos(angle), zero]).T
    triads = np.stack([first, np.cross(third, first), third], axis=1)
    both = np.concatenate([radius * out, [[9.0, 0, 0], [9.0, 0, 0.1]]])
    directors = np.concatenate([triads, [np.eye(3)] * 2]).reshape(-1, 3)
    written(tmp_path / "ring.vertex", both, f"{count + 2}\n")
    written(tmp_path / "ring.director", directors, f"{count + 2}\n")
    pairs = [[k, (k + 1) % count] for k in range(count)] + [[count, count + 1]]
    written(tmp_path / "ring.rod", pairs, f"{len(pairs)}\n")
    spacing = 2 * np.pi * radius / count
    file = f"{{kind: file, path: ring.vertex, rod: 1, spacing: {spacing!r}, closed: true}}"
    scene = build(file)
    assert scene.warnings == ()
    bending, twisting, shear, stretch = energies(scene)
    assert bending == pytest.approx(3e-3 * np.pi / radius, rel=2e-3)
    assert twisting == pytest.approx(2e-3 * np.pi * turns**2 / radius, rel=2e-3)
    assert shear + stretch < 1e-3 * bending  # chords are shorter than arcs


def test_2_a_slender_fibre_says_what_it_will_cost(tmp_path):
    path = tmp_path / "case.yaml"
    text = CASE.format(
        shape="{kind: straight, points: 32, length: 20}", bending="20", unit="um",
        strain='["0.1*sin(2*pi*s/20)", 0, 0]',
    )  # fmt: skip
    path.write_text(text.replace("shear: 0.7, stretch: 0.9", "shear: 8.0e+5, stretch: 8.0e+5"))
    case = load_case(path, ["time.end=10"])
    cost = forecast(Machine(case, build_scene(case), False))
    assert cost.evaluations > 1e7  # steps are held by the number of their stages
    said = call("info", path, "--set", "time.end=10").stdout
    assert (
        "shear and stretch set the fastest rate: a quarter of them would leave 0.25 of it" in said
    )


def test_3_an_uneven_trace_becomes_an_even_rod(build, tmp_path):
    """An arc of radius 2 over 2 rad, at uneven angles: length 4, bending energy a 4/(2 2^2)."""
    angle = 2 * np.sort(np.random.default_rng(3).uniform(size=60))
    angle[0], angle[-1] = 0, 2
    written(tmp_path / "trace.csv", 2 * np.c_[np.cos(angle), np.sin(angle)])
    scene = build("{kind: curve, path: trace.csv, points: 81}")
    assert scene.rods.lengths[0] == pytest.approx(4, rel=1e-5)
    assert energies(scene)[0] == pytest.approx(3e-3 * 4 / 8, rel=1e-3)
    assert scene.planar is False


def test_4_a_closed_centreline_of_dna_with_a_linking_number(build, tmp_path):
    """In Angstrom, in the format of particles; the case in nm."""
    u = 2 * np.pi * np.arange(120) / 120
    points = 10 * np.c_[18 * np.cos(u), 18 * np.sin(u), 2 * np.sin(3 * u)]
    rows = "".join("P {} {} {}\n".format(*row) for row in points.tolist())
    (tmp_path / "mini.xyz").write_text(f"{len(points)}\nframe\n{rows}")
    shape = "{kind: curve, path: mini.xyz, unit: Angstrom, closed: true, turns: -3}"
    scene = build(shape, unit="nm")
    position, director = scene.initial.position.T, scene.initial.director.transpose(2, 0, 1)
    assert np.hypot(*position[:, :2].T) == pytest.approx(18, rel=1e-5)
    assert writhe(position) + twist(position, director) == pytest.approx(-3, abs=1e-9)


@pytest.mark.parametrize("shape", [
    "{kind: sine, amplitude: 2.0, wavelength: 10, points: 101, length: 20}",
    "{kind: helix, radius: 1.1, pitch: 3, points: 101, length: 20}",
])  # fmt: skip
def test_5_a_rod_at_rest_in_the_shape_it_has(build, shape):
    straight = energies(build(shape))[0]
    assert straight > 1e-3
    assert energies(build(shape, "natural")).sum() < 1e-25 * straight


def test_6_a_measured_wave_as_a_sum_of_sixty_terms_and_as_a_table(build, tmp_path):
    rng = np.random.default_rng(6)
    terms = [(m, n, *rng.normal(size=2) * (0.03, 1.0)) for m in range(1, 7) for n in range(10)]
    text = " + ".join(f"({a:.6f})*cos({m}*pi*s/10 + ({p:.4f}) + {n}*300*t)" for m, n, a, p in terms)
    assert len(text) > 2000

    def wave(s, t):
        return sum(round(a, 6) * np.cos(m * np.pi * s / 10 + round(p, 4) + n * 300 * t)
                   for m, n, a, p in terms)  # fmt: skip

    straight = "{kind: straight, points: 61, length: 10}"
    s, t = (np.arange(60) + 0.5) / 6, np.array([[0.0], [0.0003], [0.00071]])
    formula = build(straight, f'["{text}", 0, 0]').entries[0][0]
    assert formula(s, t) == pytest.approx(wave(s, t), rel=1e-11, abs=1e-13)
    places, times = np.linspace(0, 10, 201), np.linspace(0, 1e-3, 101)
    values = wave(places[:, None], times)
    written(tmp_path / "kappa.txt", np.vstack([np.r_[0.0, times], np.c_[places, values]]))
    table = build(straight, "[{table: kappa.txt}, 0, 0]").entries[0][0]
    assert table(s, t) == pytest.approx(wave(s, t), abs=2e-5 * abs(values).max())


def test_9_two_stiffnesses_in_one_rod(build):
    """An arc of curvature 0.2, half of it ten times as stiff: energy 5 (a + 10 a) 0.2^2/2."""
    arc = '{kind: curve, position: ["5*cos(u)", "5*sin(u)", 0], from: 0, to: 2, points: 201}'
    scene = build(arc, bending='"where(s < 5, 3.0e-3, 3.0e-2)"')
    assert energies(scene)[0] == pytest.approx(5 * 3.3e-2 * 0.2**2 / 2, rel=1e-3)
