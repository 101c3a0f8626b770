"""Rest and stability of scenes with bodies, by command and from files."""

import numpy as np
import pytest
from calls import call
from interrupted import make

from rodsim import open_trajectory, simulate
from rodsim.scene.restore import restore_scene

pytest.importorskip("scipy")
pytestmark = pytest.mark.compiled

HANGING = """
fluid: {viscosity: 0.3, epsilon: 0.5}
bodies:
  cell: {shape: {kind: sphere, radius: 0.9, points: 20, origin: [2.9, 0, -3.46]},
         force: [0, 0, -0.4]}
rods:
  rod:
    shape: {kind: straight, points: 21, length: 4.0, rotate: {axis: [0, 1, 0], degrees: 150}}
    moduli: {bending: 1.3, twisting: 0.9, shear: 52.0, stretch: 52.0}
    strain_twist: [0.2, 0.1, 0.05]
    start: {hold: hinged}
    end: {hold: clamped, to: cell}
time: {end: 2.0}
"""


@pytest.fixture(scope="module")
def rested(tmp_path_factory):
    folder = tmp_path_factory.mktemp("hanging")
    (folder / "case.yaml").write_text(HANGING)
    done = call("rest", str(folder / "case.yaml"), "-o", str(folder / "rest.h5"))
    assert done.exit_code == 0, done.output
    return folder / "rest.h5", done.stdout


def test_rest_tells_and_stores_where_the_body_hangs(rested):
    path, said = rested
    assert "growing modes: 0, neutral: 1; stable" in said
    with open_trajectory(path) as run:
        place = run.of_bodies("position")[-1, 0]
        anchor = run.observable("anchor_force")[-1, 0]
        net = run.observable("net_force")[-1]
    assert place[:2] == pytest.approx([0, 0], abs=1e-6)
    assert anchor == pytest.approx([0, 0, 0.4], abs=1e-7)  # the hinge carries the weight
    assert net == pytest.approx([0, 0, 0], abs=1e-7)


def test_its_stability_follows_from_the_file(rested, tmp_path):
    """A hinge that turns freely: its end is where it was at the start, not at this frame."""
    out = tmp_path / "modes.h5"
    done = call("stability", str(rested[0]), "--modes", "3", "--rates", "-o", str(out))
    assert done.exit_code == 0, done.output
    assert "growing modes: 0, neutral: 1; stable" in done.stdout
    with open_trajectory(out) as run:
        ends, cell = run.position[:, -1], run.of_bodies("position")[:, 0]
    assert len(ends) == 4
    assert np.linalg.norm(ends - cell, axis=1) == pytest.approx(np.full(4, 0.9), abs=1e-3)
    assert np.ptp(cell, axis=0).max() > 0.05  # modes move the body


def test_other_forces_start_from_the_state_in_a_file(rested, tmp_path):
    out = tmp_path / "aside.h5"
    done = call("rest", str(rested[0]), "--set", "bodies.cell.force=[0.3, 0, -0.4]", "-o", str(out))
    assert done.exit_code == 0, done.output
    with open_trajectory(out) as run:
        place = run.of_bodies("position")[-1, 0]
    assert place[0] / place[2] == pytest.approx(-0.75, rel=1e-6)  # along the force from the hinge
    assert abs(place[1]) < 1e-6


def test_an_end_that_moves_from_the_start_is_restored_where_it_was(tmp_path):
    """The frame at t = 0 has it displaced already: displaced once more it would be elsewhere."""
    changes = ["bodies=null", "rods.rod.end=null", "time.end=1e-6",
               "rods.rod.start.move={displace: ['0.3*cos(t)', 0, 0]}"]  # fmt: skip
    simulate(make(tmp_path, HANGING, changes), tmp_path / "out.h5", notify=str)
    with open_trajectory(tmp_path / "out.h5") as run:
        scene = restore_scene(run)
        first = run.position[0, 0]
    assert first == pytest.approx([0.3, 0, 0], abs=1e-12)
    assert scene.initial.position[:, 0] == pytest.approx(first, abs=1e-12)
    assert scene.arrays["rod"]["held_start"][:3] == pytest.approx([0, 0, 0], abs=1e-12)
