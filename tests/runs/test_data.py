"""Data of people through the commands: exports read back, starts from outputs, runs that go on."""

import shutil

import numpy as np
import pytest
from calls import call

import rodsim
from rodsim.scene.build import build_scene
from rodsim.scene.system import RodSystem

CASE = """
units: {{length: {unit}, mass: g, time: s}}
fluid: {{viscosity: 1.3e-6, epsilon: {epsilon}}}
rods:
  loop:
    shape: {loop}
    moduli: {{bending: 3e-3, twisting: 2e-3, shear: 0.7, stretch: 0.9}}
    strain_twist: {strain}
  tail:
    shape: {tail}
    moduli: {{bending: 3e-3, twisting: 2e-3, shear: 0.7, stretch: 0.9}}
time: {{end: {end}}}
output: {{interval: 2.0e-4}}
"""
LOOP = "{kind: ring, radius: 0.9, points: 23, twist_perturbation: 0.4}"
TAIL = "{kind: helix, radius: 0.3, pitch: 0.8, points: 17, length: 2.0, origin: [0, 0, 2]}"


@pytest.fixture
def write(here):
    def make(name="case.yaml", loop=LOOP, tail=TAIL, strain="[1.1, 0, 0.6]", unit="um", end=6e-4,
             epsilon=0.3):  # fmt: skip
        text = CASE.format(loop=loop, tail=tail, strain=strain, unit=unit, end=end, epsilon=epsilon)
        (here / name).write_text(text)
        return name

    return make


@pytest.fixture
def output(write):
    result = call("run", write("first.yaml"), "-o", "first.h5")
    assert result.exit_code == 0, result.stderr
    return "first.h5"


def energies(name):
    scene = build_scene(rodsim.load_case(name))
    seen = RodSystem(scene).observe(scene.initial)[1]
    return np.array(
        [seen[f"{kind}_energy"] for kind in ("bending", "twisting", "shear", "stretch")]
    )


@pytest.mark.compiled
@pytest.mark.parametrize("suffix", [".csv", ".npz", ".h5"])
def test_exports_are_read_back_with_the_same_energies(write, output, suffix):
    if suffix != ".h5":
        assert call("export", output, "-o", f"first{suffix}").exit_code == 0
    closed = ", closed: true" if suffix == ".csv" else ""  # a .csv does not say it
    for frame in (-1, 1):
        shapes = [f"{{kind: file, path: first{suffix}, rod: {rod}, frame: {frame}{more}}}"
                  for rod, more in (("loop", closed), ("tail", ""))]  # fmt: skip
        found = energies(write("next.yaml", *shapes))
        with rodsim.open_trajectory(output) as run:
            kinds = ("bending", "twisting", "shear", "stretch")
            wanted = [run.observable(f"{kind}_energy", frame) for kind in kinds]
        assert found == pytest.approx(np.array(wanted), rel=1e-13)


@pytest.mark.compiled
def test_outputs_in_other_units_are_converted_or_refused(write, output):
    shapes = [f"{{kind: file, path: first.h5, rod: {rod}}}" for rod in ("loop", "tail")]
    scene = build_scene(rodsim.load_case(write("n.yaml", *shapes, unit="nm", strain="[0, 0, 0]",
                                               epsilon=300)))  # fmt: skip
    with rodsim.open_trajectory(output) as run:
        assert np.allclose(scene.initial.position.T, 1000 * run.position[-1], rtol=1e-12, atol=0)
        assert scene.rods.spacing == pytest.approx([1000 * rod.spacing for rod in run.rods])
    assert "lengths are in um: multiplied by 1000 to nm" in str(scene.warnings[0])
    result = call("validate", write("n.yaml", *shapes, unit="parsec"))
    assert result.exit_code == 2
    assert "cannot be converted from um to parsec" in result.stderr
    as_is = [shape[:-1] + ", as_is: true}" for shape in shapes]
    assert call("validate", write("n.yaml", *as_is, unit="parsec")).exit_code == 0
    assert call("export", output, "-o", "first.csv").exit_code == 0
    text = [shape.replace(".h5", ".csv") for shape in shapes]
    text[0] = text[0][:-1] + ", closed: true}"
    scene = build_scene(rodsim.load_case(write("n.yaml", *text, unit="nm", strain="[0, 0, 0]")))
    assert scene.rods.spacing[1] == pytest.approx(125.0)


@pytest.mark.compiled
@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("closed: false", "closed = false: the rod in the file is closed"),
        ("closed: true", None),
        ("spacing: 0.5", "spacing = 0.5 (um): the rod in the file has 0.245"),
        ("spacing: 0.2459", None),
    ],
)
def test_what_stands_beside_an_output_must_agree(write, output, more, words):
    shape = f"{{kind: file, path: first.h5, rod: loop, {more}}}"
    result = call("validate", write("next.yaml", shape))
    assert (result.exit_code == 0) == (words is None)
    assert words is None or words in result.stderr


@pytest.mark.compiled
def test_a_frame_of_a_diverged_run_is_no_start(write):
    case = write(
        "d.yaml", tail="{kind: straight, points: 41, length: 10, perturbation: 0.2}", end=0.01
    )
    fixed = ("--set", "time.integrator=euler", "--set", "time.step=1e-4", "--force")
    assert call("run", case, "-o", "d.h5", *fixed).exit_code == 3
    shape = "{kind: file, path: d.h5, rod: loop, frame: 0}"
    result = call("validate", write("next.yaml", shape))
    assert result.exit_code == 2
    assert "path = d.h5: its run diverged" in result.stderr
    assert call("validate", write("next.yaml", shape[:-1] + ", as_is: true}")).exit_code == 0


@pytest.mark.compiled
def test_info_says_how_the_rods_start(write):
    lines = call("info", write()).stdout
    assert "rod loop at t = 0: points 0.996" in lines  # sin(pi/23)/(pi/23) = 0.99689
    assert "rod tail at t = 0: energy" in lines
    bending = energies("case.yaml")[0, 1]
    assert f"bending {bending:.4g}" in lines


@pytest.mark.compiled
@pytest.mark.parametrize("kind", ["natural", "table", "tables", "curve"])
def test_a_run_goes_on_without_its_data_and_with_the_same_bits(write, tmp_path, kind):
    """What the strain twist was made from is in the output: tables may be gone by then."""
    angle = 2 * np.pi * np.arange(50) / 50
    np.savetxt("ring.csv", 0.9 * np.c_[np.cos(angle), np.sin(angle)], delimiter=",")
    s, t = np.linspace(0, 6, 30), np.linspace(0, 1e-3, 9)
    values = 1 + 0.3 * np.sin(3 * s[:, None] - 4000 * t)
    np.savetxt("k.csv", np.vstack([np.r_[0.0, t], np.c_[s, values]]), delimiter=",")
    rows = [
        [a, b, value, 0.3 * a, 0.1]
        for a, some in zip(s, values, strict=True)
        for b, value in zip(t, some, strict=True)
    ]
    np.savetxt("k3.csv", rows, delimiter=",")
    curve = "{kind: curve, path: ring.csv, points: 23, closed: true, turns: 1}"
    loop, strain = {
        "natural": (LOOP, '["natural_1 + 0.5*sin(4000*t)", natural_2, natural_3]'),
        "table": (LOOP, "[{table: k.csv}, 0, 0.1]"),
        "tables": (LOOP, "{table: k3.csv}"),
        "curve": (curve, '[natural_1, "0.5*natural_2", "0.1*cos(3000*t)"]'),
    }[kind]
    case = write(loop=loop, strain=strain, end=1e-3)
    assert call("run", case, "-o", "whole.h5").exit_code == 0

    stops = iter(["", "", "a test"])
    with pytest.raises(rodsim.errors.StoppedError):
        rodsim.simulate(rodsim.load_case(case), "part.h5", stop=lambda: next(stops, "a test"))
    for name in ("ring.csv", "k.csv", "k3.csv"):
        (tmp_path / name).unlink()
    assert call("resume", "part.h5").exit_code == 0
    with rodsim.open_trajectory("whole.h5") as whole, rodsim.open_trajectory("part.h5") as part:
        for name in ("position", "director"):
            assert np.array_equal(whole.read(name), part.read(name))
    flow = call("flow", "part.h5", "--at", "1e-3", "--grid", "plane:yz", "-o", "f.npz")
    assert flow.exit_code == 0, flow.stderr
    plain = write("plain.yaml", end=1e-3)
    assert call("run", plain, "-o", "plain.h5").exit_code == 0
    with rodsim.open_trajectory("plain.h5") as run:
        assert run.arrays("loop") == {}


@pytest.mark.compiled
def test_a_traced_wave_moves_a_rod_as_the_formula_does(write):
    """The same wave of curvature as a table and as an expression."""
    s, period = np.linspace(0, 2, 41), 2 * np.pi / 3000
    t = np.arange(33) * period / 32
    values = 1.5 * np.sin(4 * s[:, None] - 3000 * t)
    np.savetxt("k.csv", np.vstack([np.r_[0.0, t], np.c_[s, values]]), delimiter=",")
    straight = "{kind: straight, points: 17, length: 2.0, origin: [0, 0, 2]}"
    ends = []
    for number, strain in enumerate(
        ('["1.5*sin(4*s - 3000*t)", 0, 0]', f"[{{table: k.csv, period: {period!r}}}, 0, 0]")
    ):
        case = write(loop=straight, tail=TAIL, strain=strain, end=2.2 * period)
        result = call("run", case, "-o", f"{number}.h5", "--set", "time.tolerance=1e-7")
        assert result.exit_code == 0, result.stderr
        with rodsim.open_trajectory(f"{number}.h5") as run:
            ends.append(run.position[-1, :17])
            moved = abs(ends[-1] - run.position[0, :17]).max()
    assert moved > 0.05
    assert abs(ends[1] - ends[0]).max() < 2e-4 * moved


@pytest.mark.compiled
def test_one_table_of_three_moves_a_rod_as_three_tables_do(write):
    s, t = np.linspace(0, 6, 30), np.linspace(0, 1e-3, 9)
    waves = [(1 - 0.4 * i) * np.sin((2 + i) * s[:, None] - 900 * t) for i in range(3)]
    for i, wave in enumerate(waves):
        np.savetxt(f"k{i}.csv", np.vstack([np.r_[0.0, t], np.c_[s, wave]]), delimiter=",")
    pairs = np.stack(np.broadcast_arrays(s[:, None], t, *waves), axis=-1).reshape(-1, 5)
    np.savetxt("all.csv", pairs, delimiter=",", header="s,t,k1,k2,k3", comments="")
    ends = []
    for strain in (
        "[{table: k0.csv}, {table: k1.csv}, {table: k2.csv}]",
        "{table: all.csv}",
        "[{table: all.csv, columns: [s, t, k1]}, {table: k1.csv}, {table: k2.csv}]",
    ):
        result = call("run", write(strain=strain, end=5e-4), "-o", "out.h5", "--overwrite")
        assert result.exit_code == 0, result.stderr
        with rodsim.open_trajectory("out.h5") as run:
            ends.append(run.position[-1])
    assert np.array_equal(ends[0], ends[1])
    assert np.array_equal(ends[0], ends[2])
    short = call("validate", write(strain="{table: all.csv}", end=2e-3))
    assert short.exit_code == 2
    assert short.stderr.count("its times go from 0 to 0.001") == 1
    planar = call("validate", write(strain="{table: all.csv}"), "--set", "plane=yz")
    assert "Omega_2 must be the number 0 where plane is yz" in planar.stderr


@pytest.mark.compiled
def test_two_rods_far_apart_end_or_are_refused(write):
    """Rounding of the far one's positions over its spacing: 1e-3 is where it is refused."""
    far = "{kind: helix, radius: 0.3, pitch: 0.8, points: 17, length: 2.0, origin: [%g, 0, 2]}"
    result = call("run", write(tail=far % 2e10), "-o", "far.h5")
    assert result.exit_code == 0
    assert "small strains are lost" in result.stderr
    result = call("run", write(tail=far % 2e12), "-o", "far.h5")
    assert result.exit_code == 2
    assert "rods.tail.shape.origin" in result.stderr
    assert "are rounded to 0.002 of the spacing 0.125" in result.stderr


def test_python_is_told_what_looks_wrong(write):
    case = rodsim.load_case(write(epsilon=0.1))
    shutil.copy("case.yaml", "again.yaml")
    assert not build_scene(case).warnings  # the case itself has said it
    assert "fluid flows between its points" in str(case.warnings[0])
