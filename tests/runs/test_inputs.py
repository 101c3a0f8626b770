"""What a result began from is compared by its contents: shape files and frames of outputs."""

import json

import h5py
import numpy as np
import pytest
from calls import call

from rodsim import load_case, open_trajectory, resume, simulate
from rodsim.convergence.study import Study
from rodsim.errors import FileError, StoppedError
from rodsim.scene.inputs import CHANGED, GONE, SAME, case_digests, compare_inputs
from rodsim.sweep.plan import make_plan
from rodsim.sweep.standing import changed_inputs, standing
from rodsim.sweep.work import work

MODULI = "moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}"
RELAX = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.5}}
rods:
  a:
    shape: {{kind: straight, points: 11, length: 4.0}}
    {MODULI}
    strain_twist: [0.3, 0, 0]
time: {{end: 2.0e-3}}
output: {{interval: 5.0e-4}}
"""
FROM = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.5}}
rods:
  tail:
    shape: {{kind: file, path: PATH}}
    {MODULI}
time: {{end: 2.0e-3}}
output: {{interval: 5.0e-4}}
"""


def table(path, bend=0.05):
    """A straight rod along z as a text table, its last point moved along x."""
    rows = [[0.0, 0.0, 0.4 * k, 1, 0, 0, 0, 1, 0, 0, 0, 1] for k in range(9)]
    rows[-1][0] = bend
    np.savetxt(path, rows)


@pytest.fixture
def here(here):
    (here / "relax.yaml").write_text(RELAX)
    (here / "case.yaml").write_text(FROM.replace("PATH", "relax.h5"))
    (here / "text.yaml").write_text(FROM.replace("PATH", "rod.txt, spacing: 0.4, as_is: true"))
    table("rod.txt")
    return here


def relax(twist="0.3"):
    case = load_case("relax.yaml", [f"rods.a.strain_twist=[{twist}, 0, 0]"])
    simulate(case, "relax.h5", overwrite=True)


def states(name, before):
    return [state for _, state in compare_inputs(before, case_digests(load_case(name))).values()]


def test_a_digest_is_of_what_was_read(here):
    """The frame of an output and not its file: that holds the date and the seconds as well."""
    relax()
    output, text = (case_digests(load_case(name)) for name in ("case.yaml", "text.yaml"))
    assert list(output) == ["rods.tail.shape.path"]
    assert output["rods.tail.shape.path"]["file"] == str(here / "relax.h5")
    relax()
    assert states("case.yaml", output) == [SAME]
    relax("-0.3")
    assert states("case.yaml", output) == [CHANGED]
    table("rod.txt", bend=0.15)
    assert states("text.yaml", text) == [CHANGED]
    assert states("text.yaml", {}) == [CHANGED]  # a file made before there were digests
    (here / "rod.txt").unlink()
    assert states("text.yaml", text) == [GONE]
    assert case_digests(load_case("relax.yaml")) == {}


def test_another_frame_is_another_input(here):
    relax()

    def digest(frame):
        return case_digests(load_case("case.yaml", [f"rods.tail.shape.frame={frame}"]))

    assert digest(2) == digest(-3)  # of five
    assert len({json.dumps(digest(frame)) for frame in range(5)}) == 5


def test_a_file_has_digests_only_where_its_case_names_files(here):
    relax()
    simulate(load_case("case.yaml"), "out.h5")
    with h5py.File("relax.h5") as without, h5py.File("out.h5") as having:
        assert set(having["case"]) - set(without["case"]) == {"inputs"}
    with open_trajectory("out.h5") as run:
        assert json.loads(run.inputs) == case_digests(load_case("case.yaml"))
    told = call("info", "out.h5").stdout
    digest = case_digests(load_case("case.yaml"))["rods.tail.shape.path"]["sha256"]
    assert f"rods.tail.shape.path: {here / 'relax.h5'}, sha256 {digest[:16]}, unchanged" in told
    relax("-0.3")
    assert f"{digest[:16]}, has changed since" in call("info", "out.h5").stdout
    (here / "relax.h5").unlink()
    assert f"{digest[:16]}, cannot be read any more" in call("info", "out.h5").stdout


def test_a_resume_says_that_its_shape_file_has_changed(here):
    """It goes on from its checkpoint all the same: with the bits of the file it began with."""
    case = load_case("text.yaml", ["time.tolerance=1e-9"])
    simulate(case, "whole.h5")
    steps = iter(["", "", "the test"])
    with pytest.raises(StoppedError):
        simulate(case, "out.h5", stop=lambda: next(steps))
    table("rod.txt", bend=0.15)
    told = []
    resume("out.h5", notify=told.append)
    assert told == [f"{here / 'rod.txt'} has changed since this run began; "
                    "it goes on from what it began with"]  # fmt: skip
    with open_trajectory("out.h5") as run, open_trajectory("whole.h5") as whole:
        np.testing.assert_array_equal(run.position, whole.position)
        assert run.inputs == whole.inputs


def test_a_study_does_not_mix_two_scenes(here):
    study = Study(lambda more: load_case("text.yaml", more), ["epsilon"])
    rows = study.run()
    next(rows)
    table("rod.txt", bend=0.15)
    with pytest.raises(FileError, match=r"rod\.txt: has changed since"):
        list(rows)


def test_a_sweep_runs_again_what_began_from_another_file(here):
    arguments = ("sweep", "text.yaml", "--set", "fluid.viscosity=[2e-6, 3e-6]")
    runs = make_plan("text.yaml", ["fluid.viscosity=[2e-6, 3e-6]"], None, "sweep").runs
    assert work("token", runs[0], None)[0] == 0
    before = open_trajectory(runs[0].output).observable("bending_energy", -1)
    table("rod.txt", bend=0.15)
    again = make_plan("text.yaml", ["fluid.viscosity=[2e-6, 3e-6]"], None, "sweep").runs
    assert (standing(runs[0]), standing(again[0])) == ("finished", "waiting")
    assert changed_inputs(again[0]) == [str(here / "rod.txt")]
    listed = call(*arguments, "--list")
    assert len(listed.stdout.splitlines()) == 2
    assert listed.stderr == (
        f"warning: {here / 'rod.txt'} has changed: 1 of the runs that began with it are run again\n"
    )
    assert work("token", again[0], None)[0] == 0
    assert open_trajectory(runs[0].output).observable("bending_energy", -1) > 2.0 * before
    (here / "rod.txt").unlink()  # nobody can tell, and nothing could be run
    gone = make_plan("text.yaml", ["fluid.viscosity=[2e-6, 3e-6]"], None, "sweep").runs
    assert standing(gone[0]) == "finished"
