"""Contact as users meet it: refused, warned of, guarded, watched, resumed, told in info."""

import subprocess
import sys
from dataclasses import replace

import h5py
import numpy as np
import pytest
from calls import call, settings
from contents import differences
from interrupted import make, run_with_copies

from rodsim import open_trajectory, resume, simulate
from rodsim.analysis.energy import energy_table
from rodsim.errors import DivergedError
from rodsim.integrators.make import make_integrator
from rodsim.scene.build import build_scene, with_parts
from rodsim.scene.system import RodSystem

pytestmark = pytest.mark.compiled

CROSSING = """
title: crossing
parameters: {pull: 3.1}
fluid: {viscosity: 1.3, epsilon: 0.31, wall: {z: -2.3}}
rods:
  lower:
    shape: {kind: straight, points: 21, length: 2.2, origin: [-1.1, 0, 0],
            rotate: {axis: [0, 1, 0], degrees: 90}}
    moduli: {bending: 0.36, twisting: 0.29, shear: 21, stretch: 17}
    loads: {start: {at: start, force: [0, 0, pull]}, end: {at: end, force: [0, 0, pull]}}
  upper:
    shape: {kind: straight, points: 23, length: 2.2, origin: [0.1, -1.1, 0.41],
            rotate: {axis: [1, 0, 0], degrees: -90}}
    moduli: {bending: 0.36, twisting: 0.29, shear: 21, stretch: 17}
    loads: {start: {at: start, force: [0, 0, -pull]}, end: {at: end, force: [0, 0, -pull]}}
contact: {strength: 17}
time: {end: 5.2, tolerance: 1.0e-4}
output: {interval: 0.26}
"""
RING = "{kind: ring, radius: 0.17, points: 21, origin: [0, 0, 3]}"


def write(folder, text=CROSSING):
    (folder / "case.yaml").write_text(text)
    return str(folder / "case.yaml")


@pytest.fixture(scope="module")
def pressed(tmp_path_factory):
    """A run of the scene, a copy of its file after every step, and what was said."""
    folder, said = tmp_path_factory.mktemp("pressed"), []
    run = run_with_copies(make(folder, CROSSING), folder, notify=said.append)
    return *run, said


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (["contact.diameter=0.2"], ["contact.diameter = 0.2 (um): 0.2 is 1.82 spacings of rod "
         "'lower': points would slip between points; use at least 2 (better 4)"]),
        (["contact={}", "fluid.epsilon=0.13"], ["contact.diameter: 0.1577 is 1.43 spacings"]),
        (["contact.exclusion=0.3"], ["contact.exclusion = 0.3 (um): must be at least the diam"]),
        (["contact.strength=0"], ["contact.strength = 0: must be > 0"]),
        (["contact.pairs=both"], ["contact.pairs = both"]),
        (["contact.stiffness=3"], ["contact.stiffness"]),
        (["contact.diameter={epsilon: 2}"], ["contact.diameter.epsilons: missing"]),
        (["rods.upper.shape.origin=[0, -1.1, 0.15]"], ["rods.lower.shape", "point 10 is 0.15 from "
         "point 11 of rod 'upper', 0.4 contact diameters: rods cannot start inside each other",
         "contact.diameter smaller than 0.3"]),
        (["fluid.wall.z=-0.08"], ["rods.lower.shape", "point 0 is 0.16 from its image in the"]),
        (["contact.pairs=between", "rods.upper=null", "fluid.wall=null"], ["there is one rod"]),
    ],
)  # fmt: skip
def test_what_cannot_touch_rightly_is_refused(changes, words, tmp_path):
    done = call("validate", write(tmp_path), *settings(*changes))
    assert done.exit_code == 2
    for word in words:
        assert word in done.stderr


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (["contact.diameter=0.25"], "contact.diameter = 0.25 (um): 0.25 is 2.27 spacings of rod"),
        (["rods.upper.shape.origin=[0, -1.1, 0.3]"], "point 10 is 0.3 from point 11 of rod 'upper'"
         ", 0.8 contact diameters: they start in contact, and push each other apart"),
        ([f"rods.upper.shape={RING}", "rods.upper.loads=null"],
         "contact = {strength: 17}: rod 'upper' is shorter than two exclusions: no contact with"),
    ],
)  # fmt: skip
def test_what_may_go_wrong_is_warned_of(changes, words, tmp_path):
    done = call("validate", write(tmp_path), *settings(*changes))
    assert done.exit_code == 0, done.stderr
    (line,) = [line for line in done.output.splitlines() if words in line]
    assert "case.yaml" in line or "--set" in line


def test_rods_that_touch_stay_apart_and_come_to_rest(pressed):
    path, _, summary, said = pressed
    assert said == []  # that they touch is no news
    with open_trajectory(path) as run:
        gap, stored = run.observable("gap"), run.observable("contact_energy")
        length, energies = run.unit("gap"), run.unit("contact_energy")
        resultant = [run.observable(f"net_{what}") for what in ("force", "torque")]
        outside = [run.observable(f"external_{what}") for what in ("force", "torque")]
    assert stored.shape == (21, 2)
    assert (length, energies) == ("um", "g um^2 s^-2")
    assert stored[0].tolist() == [0, 0]
    assert stored[-1] == pytest.approx(0.5 * stored[-1].sum() * np.ones(2), rel=1e-12)
    d = 1.213 * 0.31
    assert 0.6 * d < gap.min() < d
    assert gap[-1] == pytest.approx(gap[-2], rel=1e-2)
    for found, expected in zip(resultant, outside, strict=True):
        assert found == pytest.approx(expected, abs=1e-10)
    assert f"the rods are {d:.3g} um thick" in summary.endings[0]


def test_the_energy_table_has_contact_and_the_ledger_closes(pressed):
    table = energy_table(pressed[0])
    rows = dict(zip(table.columns, table.rows.T, strict=True))
    assert "contact" in rows
    assert rows["total"] == pytest.approx(sum(table.rows.T[1:6]), rel=1e-14)
    kept = rows["total"] + rows["dissipated"] - rows["work"]
    assert rows["contact"].max() > 1e-3
    assert kept == pytest.approx(np.zeros(21), abs=4e-3 * rows["work"][-1])


def test_a_killed_run_goes_on_with_the_same_bits_on_any_threads(pressed, tmp_path):
    path, killed, _, _ = pressed
    copy = tmp_path / "out.h5"
    for number, threads in ((0, 2), (len(killed) // 2, 1), (len(killed) - 2, 2)):
        copy.write_bytes(killed[number].read_bytes())
        resume(copy, threads=threads)
        assert differences(copy, path) == []


def moves(case, **changes):
    """Return how far the farthest point moves in each step, less what all move, in diameters."""
    scene = build_scene(case)
    scene, found = with_parts(scene, [replace(part, **changes) for part in scene.parts]), []
    system = RodSystem(scene)
    for step in make_integrator(case.time, system).steps(scene.initial, case.time.end):
        shift = step.end.position - step.start.position
        shift[:2] -= shift[:2].mean(axis=1, keepdims=True)
        found.append(np.linalg.norm(shift, axis=0).max() / scene.parts.apart.diameter)
    return np.array(found)


LOOSE = ("time.tolerance=0.5", "parameters.pull=30", "time.end=0.2")


def test_no_point_moves_farther_in_a_step_than_the_guard_allows(tmp_path):
    guarded = moves(make(tmp_path, CROSSING, LOOSE))
    assert 0.2 < guarded.max() <= 0.25 * (1 + 1e-12)
    assert moves(make(tmp_path, CROSSING, LOOSE), guard=None).max() > 0.4


def test_a_fixed_step_that_moves_farther_stops_by_name(tmp_path):
    fixed = "time={integrator: euler, step: 0.013, end: 0.26}"
    soft = "rods.lower.moduli={bending: 0.01, twisting: 0.01, shear: 0.1, stretch: 0.1}"
    done = call("run", write(tmp_path), "-o", str(tmp_path / "out.h5"), "--force", *settings(
        fixed, "output.interval=0.13", "parameters.pull=90", soft, soft.replace("lower", "upper"),
    ))  # fmt: skip
    assert done.exit_code == 3
    assert "a point moves farther than a quarter of the contact diameter, 0.094 um" in done.stderr
    assert "halve time.step" in done.stderr


def test_rods_that_are_pressed_through_each_other_stop_by_name(tmp_path):
    """Stiff rods, weak contact: F is at most 1.5 C a/d^2 = 23 where they cross, and 120 pulls."""
    done = call("run", write(tmp_path), "-o", str(tmp_path / "out.h5"), *settings(
        "parameters.pull=60", "rods.lower.moduli.bending=7", "rods.upper.moduli.bending=9",
        "contact.strength=0.3"))  # fmt: skip
    assert done.exit_code == 3
    assert "rods 'lower' and 'upper' press through each other at points 11 and 1" in done.stderr
    assert "raise contact.strength" in done.stderr
    assert "--set contact.strength=1.2" in done.stderr
    with open_trajectory(tmp_path / "out.h5") as run:
        assert run.status == "diverged"
        assert run.observable("gap").min() > 0.5 * 1.213 * 0.31


def test_a_rod_that_is_pressed_into_the_wall_stops_by_name(tmp_path):
    changes = "fluid.wall.z=-0.2", "parameters.pull=-400", "contact.strength=0.1"
    case = make(tmp_path, CROSSING, ["rods.upper=null", *changes])
    with pytest.raises(DivergedError, match=r"rod 'lower' is pressed into the wall at point \d"):
        simulate(case, tmp_path / "out.h5")


def test_a_fibre_lies_on_the_wall_where_weight_and_contact_are_equal(tmp_path):
    """12.8 A (z/d) q^(5/2) = f per length, all along it: both are halved at the ends."""
    weight, d = 4.1, 1.213 * 0.31
    case = make(tmp_path, CROSSING, [
        "rods.upper=null", "fluid.wall.z=0", "rods.lower.shape.origin=[-1.1, 0, 0.2]",
        f"rods.lower.loads={{weight: {{along: all, force: [0, 0, -{weight}]}}}}",
        "time.end=90", "output.interval=30"])  # fmt: skip
    simulate(case, tmp_path / "out.h5")
    with open_trajectory(tmp_path / "out.h5") as run:
        z = run.position[-1, :, 2]
        gap = run.observable("gap")[-1]
    share = z / d
    q, A = 1.0 - 4.0 * share**2, 17.0 * 0.36 / d**3
    assert 12.8 * A * share * q**2.5 == pytest.approx(np.full(21, weight), rel=2e-2)
    assert z == pytest.approx(np.full(21, z[0]), rel=1e-3)
    assert gap == pytest.approx(min(2 * z.min(), 6 * 0.11), rel=1e-6)


def test_the_gap_is_that_of_points_that_are_no_neighbours_to_contact(tmp_path):
    """On a straight rod alone: the first points beyond the exclusion, 7 segments of 0.11."""
    case = make(tmp_path, CROSSING, ["rods.upper=null", "contact.exclusion=0.69", "time.end=1e-5"])
    simulate(case, tmp_path / "out.h5")
    with open_trajectory(tmp_path / "out.h5") as run:
        assert run.observable("gap")[0] == pytest.approx(7 * 0.11, rel=1e-12)


def test_info_tells_of_contact_and_of_linking_numbers(pressed, tmp_path):
    said = call("info", write(tmp_path)).stdout
    assert (
        "contact: all rods and themselves, diameter 0.37603 um = 1.213 epsilon = 3.42 spacings, "
        "strength 17; points within 5 segments of a rod ignore each other"
    ) in said
    assert "acting: elastic, loads, contact, contact_wall, fluid" in said
    told = call("info", str(pressed[0])).stdout
    assert "the rods are 0.376 um thick" in told
    assert "linking number" not in told
    assert "contact" not in call("info", write(tmp_path), "--set", "contact=null").stdout


def test_between_rods_only_a_rod_that_nears_itself_is_told_of(tmp_path):
    bent = ["contact={pairs: between}", "rods.upper.shape.origin=[9, 9, 9]", "time.end=18.2",
            "rods.lower.strain_twist=[4.2, 0, 0.5]", "rods.lower.loads=null",
            "rods.upper.loads=null"]  # fmt: skip
    for changes, told in ((bent, 1), ([*bent, "contact.pairs=all"], 0)):
        said = []
        simulate(make(tmp_path, CROSSING, changes), tmp_path / "out.h5", notify=said.append,
                 overwrite=True)  # fmt: skip
        assert [("comes closer to itself" in text) for text in said] == [True] * told


def test_a_scene_without_contact_has_nothing_of_it(tmp_path):
    case = make(tmp_path, CROSSING, ["contact=null", "time.end=1e-5"])
    assert "contact" not in case.resolved()
    simulate(case, tmp_path / "out.h5")
    with h5py.File(tmp_path / "out.h5") as file:
        assert "contact_energy" not in file["observables"]
    script = (
        "import sys, rodsim; from rodsim.run.simulate import simulate;"
        f"simulate(rodsim.load_case({str(tmp_path / 'case.yaml')!r}, {{settings}}),"
        f"{str(tmp_path / 'out.h5')!r}, overwrite=True, notify=str);"
        "print('rodsim.forces.repulsion' in sys.modules)"
    )
    for changes, imported in ((["contact=null"], "False"), ([], "True")):
        text = script.format(settings=["time.end=1e-5", *changes])
        done = subprocess.run([sys.executable, "-c", text], capture_output=True, check=True)
        assert done.stdout.decode().strip() == imported
