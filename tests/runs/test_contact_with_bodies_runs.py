"""Contact with bodies as users meet it: refused, warned of, watched, stored, resumed."""

import numpy as np
import pytest
from calls import call, settings
from contents import differences
from interrupted import make, run_with_copies

from rodsim import open_trajectory, resume, simulate
from rodsim.analysis.energy import energy_table
from rodsim.errors import DivergedError

pytestmark = pytest.mark.compiled

PRESSED = """
title: a ball on a rod, an egg on the wall
parameters: {pull: 2.3}
fluid: {viscosity: 0.23, epsilon: 0.31, wall: {z: 0}}
bodies:
  ball: {shape: {kind: sphere, radius: 0.6, points: 20, origin: [0, 0.1, 2.4]},
         force: [0, 0, -pull]}
  egg: {shape: {kind: spheroid, length: 1.9, radius: 0.5, points: 20, origin: [4, 0, 0.72],
                rotate: {axis: [0, 1, 0], degrees: 84}}, force: [0, 0, -pull]}
rods:
  bar:
    shape: {kind: straight, points: 9, length: 1.2, origin: [-0.6, 0, 1.6],
            rotate: {axis: [0, 1, 0], degrees: 90}}
    moduli: {bending: 0.36, twisting: 0.29, shear: 21, stretch: 17}
    start: {hold: hinged}
    end: {hold: hinged}
contact: {strength: 17}
time: {end: 0.4, tolerance: 1.0e-3}
output: {interval: 0.1}
"""


def write(folder):
    (folder / "case.yaml").write_text(PRESSED)
    return str(folder / "case.yaml")


@pytest.fixture(scope="module")
def pressed(tmp_path_factory):
    """A run of the scene, a copy of its file after every step, and what was said."""
    folder, said = tmp_path_factory.mktemp("pressed"), []
    path, killed, _ = run_with_copies(make(folder, PRESSED), folder, notify=said.append)
    return path, killed, said


def test_energies_of_rods_and_bodies_are_stored_and_the_ledger_closes(pressed):
    path, _, said = pressed
    assert not [text for text in said if "inside" in text or "closer" in text]
    with open_trajectory(path) as run:
        stored, gap = run.observable("contact_energy"), run.observable("gap")
        assert run.labels("contact_energy") == ["bar", "ball", "egg"]
        forces = [run.observable(f"{name}_force") for name in ("net", "external", "anchor")]
        centre = run.of_bodies("position")[-1, 0]
    assert stored.shape == (5, 3)
    assert stored[0].tolist() == [0, 0, 0]
    assert stored[-1, 0] == pytest.approx(stored[-1, 1], rel=1e-12)  # half of a pair to either
    assert stored[-1].min() > 0.0
    d = 1.213 * 0.31
    assert 0.5 * d < gap.min() < d
    assert centre[2] > 2.2  # the rod holds it
    net, external, anchors = forces
    assert net == pytest.approx(external + anchors.sum(axis=1), abs=1e-8)
    assert external[-1, 2] > -2 * 2.3  # the wall carries a share of the weights
    table = energy_table(path)
    rows = dict(zip(table.columns, table.rows.T, strict=True))
    assert rows["contact"] == pytest.approx(stored.sum(axis=1), rel=1e-14)
    kept = rows["total"] + rows["dissipated"] - rows["work"]
    assert kept == pytest.approx(np.zeros(5), abs=1e-2 * rows["work"][-1])


def test_a_killed_run_goes_on_with_the_same_bits_on_any_threads(pressed, tmp_path):
    path, killed, _ = pressed
    copy = tmp_path / "out.h5"
    for number, threads in ((len(killed) // 2, 2), (len(killed) - 2, 1)):
        copy.write_bytes(killed[number].read_bytes())
        resume(copy, threads=threads)
        assert differences(copy, path) == []


@pytest.mark.parametrize(
    ("changes", "code", "words"),
    [
        (["bodies.ball.shape.origin=[0, 0, 2.25]"], 2, ["bodies", "bar", "point 4 is 0.1 from its "
         "image in body 'ball', 0.27 contact diameters: bodies and rods cannot start inside"]),
        (["bodies.egg.shape.origin=[4, 0, 0.56]"], 2,
         ["bodies.egg.shape", "from its image in the wall, 0.", "cannot start inside each other"]),
        (["bodies.ball.shape.origin=[0, 0, 2.35]"], 0, ["point 4 is 0.3 from its image in body "
         "'ball', 0.8 contact diameters: they start in contact, and push each other apart"]),
        (["contact.pairs=between"], 0, ["valid"]),
        (["bodies.egg.shape={kind: file, path: egg.txt}"], 0,
         ["bodies.egg.shape", "keeps out neither rods nor other bodies from files"]),
    ],
)  # fmt: skip
def test_what_is_refused_and_what_is_warned_of(changes, code, words, tmp_path):
    rng = np.random.default_rng(3)
    points = rng.normal(size=(40, 3))
    points *= 0.4 / np.linalg.norm(points, axis=1)[:, None]
    np.savetxt(tmp_path / "egg.txt", points + np.array([4, 0, 0.7]))
    done = call("validate", write(tmp_path), *settings(*changes))
    assert done.exit_code == code, done.output
    for word in words:
        assert word in done.output


def test_what_is_pressed_into_a_body_stops_by_name(tmp_path):
    """The contact of a point holds 2.6 A ds at most: 17 is far more than five of them."""
    changes = "parameters.pull=90", "contact.strength=0.4", "bodies.egg=null"
    with pytest.raises(DivergedError, match=r"rod 'bar' at point \d is pressed into body 'ball'"):
        simulate(make(tmp_path, PRESSED, changes), tmp_path / "out.h5", notify=str)


def test_a_stick_that_turns_asks_for_shorter_steps(tmp_path):
    """Its ends go far where its centre stays: no step turns them by more than d/4."""
    from rodsim.integrators.make import make_integrator
    from rodsim.scene.build import build_scene
    from rodsim.scene.system import RodSystem

    stick = "bodies={stick: {shape: {kind: spherocylinder, length: 3.2, radius: 0.3, points: 20, "
    stick += "origin: [0, 0, 6]}, torque: [70, 0, 0]}}"
    case = make(tmp_path, PRESSED, [stick, "time.tolerance=0.5", "time.end=0.2"])
    scene = build_scene(case)
    steps = make_integrator(case.time, system := RodSystem(scene)).steps(scene.initial, 0.2)
    turns = [np.linalg.norm(system.split(step.increment)[1][:, -1]) for step in steps]
    limit = 0.25 * 1.213 * 0.31 / 1.3
    assert 0.3 * limit < max(turns) <= limit * (1 + 1e-9)
