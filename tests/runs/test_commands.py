"""The commands as users meet them: what they print, where, and how they end."""

import csv
import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import yaml
from calls import call
from scenes import CONFIGS, ROOT, load

import rodsim
from rodsim import open_trajectory
from rodsim.cli import COMMANDS, main
from rodsim.errors import DivergedError, StepFailure
from rodsim.scene.build import build_scene

RING = str(CONFIGS / "closed_ring.yaml")
SHORT = ("--set", "rods.ring.shape.points=40", "--set", "time.end=2e-3")


ENDLESS = ("--set", "time.max_step=1e-9")  # 1e8 steps: it cannot end before it is stopped


def wait_for_frames(path, writer):
    """Wait, however busy the machine is, for the first frame of a run in another process."""
    while writer.poll() is None:
        time.sleep(0.05)
        if path.exists():
            with open_trajectory(path) as trajectory:
                if trajectory.frames:
                    return
    raise AssertionError("ended without a frame")


def test_run_then_energy_in_an_empty_folder(here):
    run = call("run", RING, *SHORT)
    assert run.exit_code == 0
    assert run.stdout == ""  # results go to the file, all else to stderr
    assert "finished: 3 frames in out.h5" in run.stderr
    assert "evaluations" in run.stderr
    assert "compile" in run.stderr
    assert [path.name for path in here.iterdir()] == ["out.h5"]  # no lock, nothing temporary
    energy = call("energy", "out.h5")
    assert energy.exit_code == 0
    lines = energy.stdout.splitlines()
    assert lines[0] == "energies in g um^2 s^-2, time in s"
    assert lines[1].split() == ["time", "bending", "twisting", "shear", "stretch", "total"]
    rows = np.array([line.split() for line in lines[2:]], dtype=float)
    assert rows[:, 0] == pytest.approx([0.0, 1e-3, 2e-3])
    assert rows[:, 1:5].sum(axis=1) == pytest.approx(rows[:, 5], rel=1e-5)


def test_energy_in_kt_and_to_csv(here):
    call("run", RING, *SHORT, "-q")
    plain, thermal = (
        call("energy", "out.h5"),
        call("energy", "out.h5", "--kT", 298, "--csv", "e.csv"),
    )
    total = [float(result.stdout.splitlines()[2].split()[-1]) for result in (plain, thermal)]
    assert total[0] / total[1] == pytest.approx(4.114e-6, rel=2e-4)  # four printed digits
    with open("e.csv", newline="") as stream:
        table = list(csv.reader(stream))
    assert table[0][:2] == ["time (s)", "bending (kT at 298 K)"]
    assert len(table) == 4
    assert float(table[1][-1]) == pytest.approx(total[1], rel=1e-6)


def test_energy_picture(here):
    pytest.importorskip("matplotlib")
    call("run", RING, *SHORT, "-q", "--set", "fluid.density=1e-12")
    assert call("energy", "out.h5", "--plot", "e.png").exit_code == 0
    assert (here / "e.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    refused = call("energy", "out.h5", "--plot", "e.nonsense")
    assert refused.exit_code == 2
    assert "e.nonsense" in refused.stderr


def test_an_existing_output_is_renamed_or_replaced(here):
    (here / "out.h5").write_text("precious")
    run = call("run", RING, *SHORT)
    assert "the earlier out.h5 is now out.1.h5" in run.stderr
    assert (here / "out.1.h5").read_text() == "precious"
    call("run", RING, *SHORT, "--overwrite")
    assert sorted(path.name for path in here.iterdir()) == ["out.1.h5", "out.h5"]


def test_an_output_that_another_process_is_writing_is_refused(here):
    with subprocess.Popen(
        [sys.executable, "-m", "rodsim", "run", RING, *ENDLESS],
        stderr=subprocess.DEVNULL,
    ) as writer:
        wait_for_frames(here / "out.h5", writer)
        refused = call("run", RING, *SHORT)
        writer.send_signal(signal.SIGINT)
        writer.wait()
    assert refused.exit_code == 4
    assert f"process {writer.pid}" in refused.stderr
    assert writer.returncode == 75
    with open_trajectory("out.h5") as trajectory:
        assert trajectory.status == "stopped"
        assert trajectory.frames >= 1


EULER = (
    "--set",
    "time.integrator=euler",
    "--set",
    "time.end=0.02",
    "--set",
    "output.interval=1e-4",
)


def test_a_step_above_its_limit_is_refused_before_anything_is_written(here):
    """40 points: 2/rho is 7.35e-5 s."""
    run = call("run", RING, *SHORT, *EULER, "--set", "time.step=1e-4")
    assert run.exit_code == 2
    assert "--set: time.step = 0.0001 (s): is above the largest stable step of euler" in run.stderr
    assert "7.3" in run.stderr
    assert "--force" in run.stderr
    assert list(here.iterdir()) == []


def test_a_step_near_its_limit_is_warned_of(here):
    near = (
        "--set",
        "time.step=6.25e-5",
        "--set",
        "time.end=1e-3",
        "--set",
        "output.interval=2.5e-4",
    )
    run = call("run", RING, *SHORT, *EULER, *near)
    assert run.exit_code == 0
    assert (
        "warning: --set: time.step = 6.25e-05 (s): is 85% of the largest stable step" in run.stderr
    )


def test_a_rate_that_grows_during_the_run_stops_it_by_name(here):
    """A rod that coils up as its curvature is raised: its points come closer to each other, and
    the step that was below its limit by 1 % at first is above it by more than 2 % later."""
    text = """
fluid: {viscosity: 1.0e-6, epsilon: 0.2}
rods:
  rod:
    shape: {kind: straight, points: 12, spacing: 0.2}
    moduli: {bending: 3.0e-3, twisting: 2.0e-3, shear: 0.7, stretch: 0.9}
    strain_twist: ["min(20000*t, 8)", 0, 2]
time: {end: 0.01, integrator: euler, step: STEP}
output: {interval: 1.0e-4}
"""
    (here / "case.yaml").write_text(text.replace("STEP", "1.25e-6"))
    run = call("run", "case.yaml")
    assert run.exit_code == 3
    assert "the fastest rate has grown to" in run.stderr
    with open_trajectory("out.h5") as trajectory:
        assert trajectory.status == "diverged"
        assert np.isfinite(trajectory.position).all()


def test_a_forced_run_that_diverges_keeps_its_frames_and_says_what_to_do(here):
    run = call("run", RING, "-o", "a b.h5", *SHORT, *EULER, "--set", "time.step=1e-4", "--force")
    assert run.exit_code == 3
    assert "diverged in step" in run.stderr
    assert "rod 'ring', point" in run.stderr
    assert "halve time.step, or use integrator: rkc" in run.stderr
    assert "Traceback" not in run.stderr
    advice = shlex.split(run.stderr.partition("Try: rodsim ")[2].splitlines()[0])
    assert advice[:2] == ["run", RING]
    assert advice[-2:] == ["-o", "a b.h5"]
    assert sum(word.startswith("time.integrator=") for word in advice) == 1
    with open_trajectory("a b.h5") as trajectory:
        assert trajectory.status == "diverged"
        assert trajectory.frames >= 2
        assert f"Last good frame: {trajectory.frames - 1}" in run.stderr
        assert np.isfinite(trajectory.position).all()
    assert call(*advice, "-q").exit_code == 0


def test_a_run_whose_steps_fail_says_where_and_which_command_may_help():
    from rodsim.run.machine import Machine

    case = load("closed_ring", "rods.ring.shape.points=40", "rods.ring.strain_twist=[1.2, 0, 0.5]")
    machine = Machine(case, build_scene(case), force=False)
    failure = StepFailure("no step is accepted", machine.system.scene.initial)
    with pytest.raises(DivergedError) as caught:
        machine.watch.stop(failure, 8)
    assert str(caught.value).splitlines() == [
        "diverged in step 8, after t = 0: no step is accepted.",
        "Last good frame: 0. Usual cause: the motion is beyond the resolution of the rods:"
        " use more points, or a smaller time.tolerance.",
        f"Try: rodsim run {RING} --set rods.ring.shape.points=40"
        " --set 'rods.ring.strain_twist=[1.2, 0, 0.5]' --set time.tolerance=1e-05",
    ]


def test_frames_are_at_their_exact_times(here):
    call("run", RING, *SHORT, "-q", "--set", "output.interval=3e-4")
    with open_trajectory("out.h5") as trajectory:
        expected = [*(3e-4 * np.arange(7)), 2e-3]
        assert trajectory.time == pytest.approx(expected, rel=1e-12)
        assert trajectory.time[-1] == 2e-3
    fixed = ("--set", "time.integrator=rk4", "--set", "time.step=1e-6", "--set", "time.end=2e-5")
    call("run", RING, *SHORT, *fixed, "-q", "--set", "output.interval=5e-6", "--overwrite")
    with open_trajectory("out.h5") as trajectory:
        assert trajectory.steps.tolist() == [0, 5, 10, 15, 20]


def test_dry_run_and_info_describe_without_writing(here):
    for result in (call("run", RING, "--dry-run"), call("info", RING)):
        assert result.exit_code == 0
        assert "rod ring: 200 points, closed" in result.stdout
        assert "fastest rate" in result.stdout
        assert "largest stable step (s): rk4 4.2" in result.stdout
        assert "euler 3.0" in result.stdout
    assert list(here.iterdir()) == []


def test_info_of_an_output(here):
    call("run", RING, *SHORT, "-q")
    result = call("info", "out.h5")
    assert result.exit_code == 0
    assert "out.h5: finished\n3 of 3 frames, t = 0 to 0.002 s" in result.stdout
    assert "--set time.end=2e-3" in result.stdout


@pytest.mark.parametrize("kind", ["open", "ring", "flagellum"])
def test_new_writes_a_case_that_is_valid(kind, here):
    assert call("new", kind, "case.yaml").exit_code == 0
    assert call("new", kind).stdout == (here / "case.yaml").read_text()
    valid = call("validate", "case.yaml")
    assert (valid.exit_code, valid.stdout) == (0, "case.yaml: valid\n")
    again = call("new", kind, "case.yaml")
    assert again.exit_code == 4
    assert "exists already" in again.stderr


def test_new_lists_all_that_is_shipped_and_writes_each_with_what_it_reads(here):
    listed = [line.split(maxsplit=1) for line in call("new").stdout.splitlines()]
    shipped = {path.stem for path in CONFIGS.iterdir()} - {"rodsim.schema"}
    assert {name for name, _ in listed} == shipped | {"open", "ring", "flagellum"}
    cases = [name for name, _ in listed if (CONFIGS / f"{name}.yaml").exists()]
    for name in cases:
        assert call("new", name, f"my_{name}.yaml").exit_code == 0
        assert "$schema" not in (here / f"my_{name}.yaml").read_text()  # of a file not here
        assert rodsim.load_case(f"my_{name}.yaml").rods
    assert (here / "traced_filament.csv").exists()


def test_new_leaves_a_table_that_is_another_alone(here):
    table = here / "traced_filament.csv"
    table.write_text("s,kappa\n0,2\n")
    result = call("new", "traced_filament", "case.yaml")
    assert (result.exit_code, "traced_filament.csv: exists" in result.stderr) == (4, True)
    assert [path.name for path in here.iterdir()] == [table.name]
    table.unlink()
    for case in ("case.yaml", "other.yaml"):  # the second finds the very same table
        assert call("new", "traced_filament", case).exit_code == 0


def test_new_of_a_name_that_is_none_says_which_is_near():
    result = call("new", "closed_rign")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "did you mean 'closed_ring'" in result.stderr


def test_validate_reports_on_every_file(here):
    (here / "bad.yaml").write_text("fluid: {viscosity: -2, epsilon: 0.3}\n")
    result = call("validate", RING, "bad.yaml")
    assert result.exit_code == 2
    assert f"{RING}: valid" in result.stdout
    assert "bad.yaml:1: fluid.viscosity = -2: must be > 0" in result.stderr


def test_schema_is_json_and_accepts_the_configs(here):
    schema = json.loads(call("schema").stdout)
    assert schema["$schema"] == "http://json-schema.org/draft-07/schema#"
    assert set(schema["required"]) == {"fluid", "rods", "time"}


def test_cite_has_this_version_and_the_paper_for_people_and_for_bibtex():
    cff = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert cff["version"] == rodsim.__version__
    text = call("cite").stdout
    for words in (f"version {rodsim.__version__}", "238 (2013) 169\u2013187", cff["title"]):
        assert words in text
    entries = call("cite", "--bibtex").stdout
    assert text.endswith(entries)
    assert "author = {Olson, Sarah D. and Lim, Sookkyung and Cortez, Ricardo}," in entries
    assert "pages = {169--187}," in entries
    assert "author = {{The rodsim developers}}," in entries  # one name, not a list of words
    assert entries.count("{") == entries.count("}")


@pytest.mark.parametrize("name", ["", *COMMANDS])
def test_no_line_of_a_help_is_longer_than_a_terminal(name):
    arguments = [name, "--help"] if name else ["--help"]
    text = call(*arguments, terminal_width=80).stdout
    assert max(map(len, text.splitlines())) <= 80


def test_the_list_of_commands_has_their_first_sentences_whole():
    listed = call("--help", terminal_width=80).stdout
    flat = " ".join(listed.split())
    for name in COMMANDS:
        text = " ".join(main.get_command(None, name).help.split("\n\n")[0].split())
        assert f" {name} {text.partition('. ')[0].rstrip('.')}" in flat


def test_version():
    assert rodsim.__version__ in call("--version").stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("energy", "missing.h5"), "missing.h5: no such file"),
        (("energy", "text.h5"), "not an HDF5 file"),
        (("plot", RING), f"not an HDF5 file, but a case? First rodsim run {RING}, then give its"),
        (("resume", RING), "not an HDF5 file, but a case? First rodsim run"),
        (("info", "text.h5"), "not an HDF5 file"),
        (("run", RING, "-o", "no/such/folder/out.h5"), "no folder"),
        (("run", RING, "-q", "-o", "a" * 247 + ".h5"), ".h5: cannot be written: its name is too "),
    ],
)
def test_files_that_are_no_use_end_with_code_4_in_one_line(arguments, words, here):
    (here / "text.h5").write_text("hello")
    result = call(*arguments)
    assert result.exit_code == 4
    assert words in result.stderr
    assert len(result.stderr.splitlines()) == 1


@pytest.mark.parametrize("command", ["run", "rest"])
def test_an_output_that_cannot_be_is_refused_before_anything_is_compiled(
    command, here, monkeypatch
):
    def compiled(*_):
        raise AssertionError("compiled before the output was looked at")

    monkeypatch.setattr("rodsim.run.warmup.ensure_compiled", compiled)
    result = call(command, RING, "-o", "no/such/folder/out.h5")
    assert result.exit_code == 4
    assert result.stderr == "no/such/folder/out.h5: there is no folder no/such/folder\n"


def test_a_missing_shape_file_is_an_error_4(here):
    (here / "case.yaml").write_text(
        "fluid: {viscosity: 2e-6, epsilon: 0.3}\n"
        "rods: {r: {shape: {kind: file, path: gone.txt, spacing: 0.2},"
        " moduli: {bending: 3e-3, twisting: 2e-3, shear: 0.7, stretch: 0.9}}}\n"
        "time: {end: 0.5}\n"
    )
    result = call("run", "case.yaml")
    assert result.exit_code == 4
    assert "gone.txt: no such file" in result.stderr


def test_a_rod_starts_from_an_earlier_output(here):
    call("run", RING, *SHORT, "-q", "-o", "first.h5")
    text = (CONFIGS / "closed_ring.yaml").read_text()
    shape = text[text.index("{kind: ring") : text.index("}", text.index("{kind: ring")) + 1]
    (here / "next.yaml").write_text(text.replace(shape, "{kind: file, path: first.h5, frame: 1}"))
    result = call("run", "next.yaml", "--set", "time.end=1e-4", "-o", "next.h5")
    assert result.exit_code == 0, result.stderr
    with open_trajectory("first.h5") as first, open_trajectory("next.h5") as then:
        assert np.array_equal(then.position[0], first.position[1])
        assert np.array_equal(then.director[0], first.director[1])
        assert then.rods[0].closed
        assert then.rods[0].spacing == first.rods[0].spacing


def test_quiet_says_nothing(here):
    result = call("run", RING, *SHORT, "-q")
    assert (result.exit_code, result.output) == (0, "")


def test_ctrl_c_keeps_what_there_is_and_ends_with_75(here):
    with subprocess.Popen(
        [sys.executable, "-m", "rodsim", "run", RING, *ENDLESS],
        stderr=subprocess.PIPE, text=True,
    ) as writer:  # fmt: skip
        wait_for_frames(here / "out.h5", writer)
        writer.send_signal(signal.SIGINT)
        _, said = writer.communicate()
    assert writer.returncode == 75
    assert "Traceback" not in said
    assert "stopped by SIGINT at t = " in said
    assert "rodsim resume out.h5" in said
    assert not (here / "out.h5.lock").exists()


def test_a_read_only_folder_is_an_error_4(here):
    if os.geteuid() == 0:
        pytest.skip("root may write anywhere")
    folder = here / "closed"
    folder.mkdir()
    folder.chmod(0o500)
    result = call("run", RING, *SHORT, "-o", folder / "out.h5")
    assert result.exit_code == 4


def test_a_disk_that_is_too_small_shows_before_the_run(here, monkeypatch):
    monkeypatch.setattr(shutil, "disk_usage", lambda path: shutil._ntuple_diskusage(9, 9, 1000))
    result = call("run", RING, *SHORT)
    assert result.exit_code == 4
    assert "1 kB are free" in result.stderr
    assert list(here.iterdir()) == []


def test_info_says_what_became_of_copies_and_compares_scenes(here):
    two = call("info", str(CONFIGS / "two_flagella.yaml")).stdout
    assert "parameters: k = 1.25664, b = 0.3, sigma = 400, period = 0.015708, d = 1\n" in two
    assert "rod right (like left): 151 points" in two
    assert "; phi = 3.14159\n" in two
    assert "viscosity 1e-06 g um^-1 s^-1 (1 mPa s)" in two
    # xi = 4 pi mu/(ln(L/r) + 1/2), tau = xi L^4/a, Sp = L (xi sigma/a)^(1/4), by hand
    radius = 4 * 20 / 150 * np.exp(-0.5)
    drag = 4 * np.pi * 1e-6 / (np.log(20 / radius) + 0.5)
    assert f"elasto-viscous time {drag * 20**4 / 3.5e-2:.4g} s, drive 400 rad/s" in two
    assert f"sperm number {20 * (drag * 400 / 3.5e-2) ** 0.25:.4g}\n" in two
    row = call("info", str(CONFIGS / "carpet.yaml"), "--set", "parameters.n=4").stdout
    assert "rods flagellum_0 to flagellum_3 (flagellum, repeated): 41 points" in row
    force = call("info", RING, "--set", "units={force: pN}").stdout
    assert "viscosity 1e-06 pN um^-2 s (0.001 mPa s)" in force


def test_a_run_in_units_of_force_says_them(here):
    small = ("--set", "rods.ring.shape.points=40", "--set", "time.end=1e-5")
    assert call("run", RING, "--set", "units={force: pN}", *small).exit_code == 0
    with open_trajectory("out.h5") as run:
        assert run.unit("bending_energy") == "pN um"
        assert run.units["mass"] == "pN um^-1 s^2"
    assert "kT" in call("energy", "out.h5", "--kT", "298").stdout
