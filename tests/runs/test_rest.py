"""rodsim rest, stability, sweep --rest: files, refusals, exit codes."""

import csv
import subprocess
import sys

import numpy as np
import pytest
from calls import call, command, settings
from scenes import CONFIGS

from rodsim import open_trajectory
from rodsim.analysis.strain import strain_twist

pytestmark = pytest.mark.compiled


CIRCLE = settings("rods.ring.shape.points=40")
MICHELL = CONFIGS / "michell_ring.yaml"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with the ring at rest beyond its twist: kept as a saddle, and left."""
    folder = tmp_path_factory.mktemp("rest")
    command("rest", MICHELL, *CIRCLE, "--saddle", "-o", folder / "saddle.h5", "-q")
    command("rest", MICHELL, *CIRCLE, "-o", folder / "rest.h5", "-q")
    return folder


def test_the_output_is_one_of_the_usual_kind(folder, tmp_path):
    with open_trajectory(folder / "rest.h5") as run:
        assert (run.status, run.frames) == ("finished", 2)
        energy = sum(run.observable(f"{k}_energy")[:, 0] for k in ("bending", "twisting"))
        assert energy[1] < 0.5 * energy[0]
        assert run.observable("growing_modes").tolist() == [-1, 0]
        assert run.observable("residual")[1] < 1e-7
        assert run.observable("linking_number")[:, 0] == pytest.approx([0.0, 2.0], abs=1e-9)
    report = command("info", "--check", folder / "rest.h5").stdout
    assert "2 frames are whole" in report
    assert "still moving" not in command("info", folder / "rest.h5").stdout
    command("energy", folder / "rest.h5")
    command("plot", folder / "rest.h5", "-o", tmp_path / "rest.png")
    command("export", folder / "rest.h5", "-o", tmp_path / "rest.csv")
    assert (tmp_path / "rest.png").stat().st_size > 10_000


def test_what_it_says(tmp_path):
    said = command("rest", MICHELL, *CIRCLE, "-o", tmp_path / "out.h5")
    assert "growing modes: 0, neutral: 7; stable" in said.stdout
    assert "linking number 0 -> 2" in said.stdout
    assert "led rod ring through itself" in said.stdout
    assert "states at rest that are not stable" in said.stdout
    again = command("rest", MICHELL, *CIRCLE, "--saddle", "-o", tmp_path / "out.h5")
    assert "growing modes: 2, neutral: 7; NOT STABLE" in again.stdout
    assert f"is now {tmp_path / 'out.1.h5'}" in again.stderr


def last(path):
    with open_trajectory(path) as run:
        return run.read("position", -1), run.observable("linking_number", -1)


def test_a_rest_starts_from_a_rest(folder, tmp_path):
    """From the output itself, or the case with its shapes: the same state again."""
    command("rest", folder / "rest.h5", "-o", tmp_path / "one.h5", "-q")
    command("rest", MICHELL, *CIRCLE, "--from", folder / "rest.h5", "-o", tmp_path / "two.h5", "-q")
    there = last(folder / "rest.h5")
    for name in ("one.h5", "two.h5"):
        found = last(tmp_path / name)
        assert np.ptp(np.linalg.norm(found[0] - found[0].mean(axis=0), axis=1)) < 1e-6  # a circle
        assert found[1] == pytest.approx(there[1], abs=1e-9)


def test_a_rest_of_another_case_starts_from_a_rest(folder, tmp_path):
    """Less twist at the same linking number 2: 2/r0 - 0.3 is stored, 2/r0 to O(ds^2), 0.7 %."""
    output = tmp_path / "out.h5"
    command(
        "rest", folder / "rest.h5", *settings("rods.ring.strain_twist=[0, 0, 0.3]"), "-o", output
    )
    with open_trajectory(output) as run:
        expected = 0.5 * 3.5e-3 * (2.0 / 2.5 - 0.3) ** 2 * 5 * np.pi
        assert run.observable("twisting_energy", -1)[0] == pytest.approx(expected, rel=2.5e-2)
    idle = command("rest", folder / "rest.h5", *settings("parameters.twist=1.9"), code=2)
    assert "--set parameters.twist=1.9: changes nothing" in idle.stderr


def test_a_run_starts_from_a_rest_and_is_resumed(folder, tmp_path):
    """It stays where it is; the case in the file says where it came from."""
    short = settings("time.end=1e-3", "output.interval=1e-3")
    output = tmp_path / "run.h5"
    command("run", MICHELL, *CIRCLE, *short, "--from", folder / "rest.h5", "-o", output, "-q")
    command("resume", output, "--set", "time.end=2e-3", "-q")
    with open_trajectory(output) as run:
        start = last(folder / "rest.h5")[0]
        assert abs(run.position - start).max() < 1e-9
        assert run.frames == 3
        assert run.case_data()["initial"]["path"] == str(folder / "rest.h5")


def test_stability_of_a_saddle_and_its_modes(folder, tmp_path):
    modes, table = tmp_path / "modes.h5", tmp_path / "modes.csv"
    said = command("stability", folder / "saddle.h5", "--modes", 3, "--rates", "--csv", table,
                "-o", modes)  # fmt: skip
    assert "growing modes: 2, neutral: 7" in said.stdout
    assert "growth rates: 28.5725, 28.5725 s^-1" in said.stdout  # of another program
    rows = list(csv.reader(table.open()))
    assert len(rows) == 4
    assert float(rows[1][1]) < 0.0 < float(rows[3][1])
    assert float(rows[1][2]) == pytest.approx(28.5725, rel=1e-5)
    with open_trajectory(modes) as run:
        assert run.frames == 4
        assert run.observable("mode_stiffness")[1] == pytest.approx(float(rows[1][1]), rel=1e-12)
        moved = np.linalg.norm(run.position[1:] - run.position[0], axis=2).max(axis=1)
        assert moved == pytest.approx(0.05 * 5 * np.pi, rel=0.5)
    command("plot", modes, "-o", tmp_path / "modes.png")


def test_what_is_not_at_rest_is_refused(tmp_path):
    where = settings("rods.ring.strain_twist=[0.3, 0, 0.2]", "rods.ring.shape.twist_perturbation=1")
    said = command("stability", MICHELL, *CIRCLE, *where, "-o", tmp_path / "no.h5", code=2)
    assert "not at rest: residual" in said.stderr
    assert "rodsim rest" in said.stderr
    assert not (tmp_path / "no.h5").exists()


def test_what_cannot_come_to_rest_ends_with_3_and_says_why(tmp_path):
    output = tmp_path / "falls.h5"
    said = command("rest", CONFIGS / "sedimenting_fibre.yaml", "-o", output, code=3)
    assert "nothing holds the scene against its net force (0, 0, -0.007)" in said.stderr
    with open_trajectory(output) as run:
        assert run.status == "diverged"
    few = settings("rest.steps=3")
    said = command("rest", MICHELL, *CIRCLE, *few, "-o", output, code=3)
    assert "not at rest after 3 steps (rest.steps)" in said.stderr


@pytest.mark.parametrize(
    ("config", "options", "reason"),
    [
        ("flagellum", (), "the strain twist depends on time: say with --at"),
        ("fibre_in_shear", (), "a background flow moves the rods"),
        ("michell_ring", ("--from", "missing.h5"), "missing.h5: no such file"),
    ],
)
def test_what_rest_refuses(config, options, reason, tmp_path):
    result = call("rest", CONFIGS / f"{config}.yaml", *options, "-o", tmp_path / "no.h5")
    assert result.exit_code in (2, 4)
    assert reason in result.stderr


DRIVEN = """
fluid: {viscosity: 1.3e-6, epsilon: 0.3}
rods:
  beam:
    shape: {kind: straight, points: 12, spacing: 0.2}
    moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}
    strain_twist: ["0.4*t", 0, "0.3*t"]
time: {end: 5.0}
"""


@pytest.mark.parametrize(("time", "last"), [(0.7, pytest.approx(0.7, abs=1e-6)), (0.0, 5.0)])
def test_what_is_driven_is_taken_at_the_time_that_is_asked_for(time, last, here):
    """Free of stress with the strain twist of that time, good to the tolerance of the search."""
    (here / "case.yaml").write_text(DRIVEN)
    command("rest", "case.yaml", "--at", time, "-o", "out.h5", "-q")
    with open_trajectory("out.h5") as run:
        found = strain_twist(run.director[-1], 0.2, False)
        assert run.time[0] == time
        assert run.time[1] == last
        assert run.time[1] > time
    assert found == pytest.approx(np.tile([0.4 * time, 0, 0.3 * time], (11, 1)), abs=1e-7)
    said = command("stability", "out.h5", "--at", time, "-o", "modes.h5").stdout
    assert "growing modes: 0, neutral: 6" in said
    assert "say with --at when" in command("stability", "out.h5", code=2).stderr
    if time:  # another time is not where it rests
        assert "rest" in command("stability", "out.h5", "--at", 2 * time, code=2).stderr


@pytest.mark.parametrize("time", ["nan", "inf", "-0.1", "5.1"])
def test_a_time_that_the_case_does_not_reach_is_refused(time, here):
    (here / "case.yaml").write_text(DRIVEN)
    said = command("rest", "case.yaml", "--at", time, code=2).stderr
    assert f"--at {time}: not between 0 and time.end = 5, where" in said
    assert [path.name for path in here.iterdir()] == ["case.yaml"]


@pytest.mark.long
def test_a_driven_rod_rests_at_a_time(tmp_path):
    """The flagellum's wave, stopped: free of stress as the sine it is at that time."""
    points = settings("rods.tail.shape.points=100", "rods.tail.shape.spacing=0.4")
    said = command("rest", CONFIGS / "flagellum.yaml", *points, "--at", "0.002",
                "-o", tmp_path / "out.h5")  # fmt: skip
    assert "growing modes: 0, neutral: 3; stable" in said.stdout
    with open_trajectory(tmp_path / "out.h5") as run:
        assert run.time[0] == 0.002
        assert run.observable("bending_energy", -1).sum() < 1e-15


def test_a_state_at_rest_is_no_run_to_go_on_with(folder):
    said = command("resume", folder / "rest.h5", code=4)
    assert "is no run, but states at rest" in said.stderr


@pytest.mark.long
def test_a_diagram_there_and_back(tmp_path):
    """Stable as a circle up to the twist of theory; back on the branch it fell to: hysteresis."""
    values = "parameters.twist=[1.70, 1.75, 1.70]"
    sweep = ["sweep", MICHELL, *CIRCLE, "--rest", "--from", "previous", *settings(values), "-q"]
    picture = tmp_path / "diagram.png"
    command(*sweep, "-o", tmp_path / "s", "--plot", "twist", "total_energy", picture)
    rows = list(csv.DictReader((tmp_path / "s" / "summary.csv").open()))
    energies = [float(row["total_energy (g um^2 s^-2)"]) for row in rows]
    assert [row["growing_modes"] for row in rows] == ["0.0", "0.0", "0.0"]
    assert energies[1] < 0.5 * energies[0]
    assert energies[2] < 0.5 * energies[0]
    assert [float(row["linking_number"]) for row in rows] == pytest.approx([0, 2, 2], abs=1e-9)
    assert picture.stat().st_size > 10_000
    before = (tmp_path / "s" / "002_twist=1.7" / "out.h5").stat().st_mtime_ns
    command(*sweep, "-o", tmp_path / "s")  # nothing is left to do
    assert (tmp_path / "s" / "002_twist=1.7" / "out.h5").stat().st_mtime_ns == before


@pytest.mark.long
def test_a_diagram_of_saddles(tmp_path):
    """The circle itself, followed beyond its twist: two modes grow there."""
    values = settings("parameters.twist=[1.70, 1.75]")
    command(
        "sweep",
        MICHELL,
        *CIRCLE,
        "--rest",
        "--saddle",
        *values,
        "-o",
        tmp_path / "s",
        "-q",
        "-j",
        1,
    )
    rows = list(csv.DictReader((tmp_path / "s" / "summary.csv").open()))
    assert [row["growing_modes"] for row in rows] == ["0.0", "2.0"]


def test_options_that_do_not_fit_are_refused(tmp_path):
    said = command("sweep", MICHELL, "--from", "previous", "-o", tmp_path / "s", code=2)
    assert "--from is for sweeps with --rest" in said.stderr


@pytest.mark.long
def test_a_plain_run_does_not_import_scipy(tmp_path):
    code = (
        "import sys\nfrom rodsim.cli import main\n"
        f"main(['run', {str(MICHELL)!r}, '--set', 'time.end=1e-4', '-o', 'out.h5', '-q'],"
        " standalone_mode=False)\n"
        "sys.exit('scipy' in sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True)
