"""Sweeps: what is run, what is skipped and resumed, and what a killed worker does to them."""

import csv
import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
import threading
import time
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from calls import call
from scenes import CONFIGS

from rodsim import open_trajectory, simulate
from rodsim.case import load_case
from rodsim.errors import CaseError, UsageError
from rodsim.output.paths import OutputLock, writing_process
from rodsim.sweep.names import folder_name
from rodsim.sweep.plan import Plan, make_plan
from rodsim.sweep.series import series
from rodsim.sweep.standing import standing
from rodsim.sweep.summary import Summary
from rodsim.sweep.table import read_table
from rodsim.sweep.work import command, work

RING = str(CONFIGS / "closed_ring.yaml")
SHORT = ("--set", "rods.ring.shape.points=40", "--set", "time.end=2e-3")
SWIMMING = CONFIGS / "sweep_swimming_speed.csv"
K = 1.2566370614359172  # um^-1, of the flagellum


def rows(path="sweep/summary.csv"):
    with open(path, newline="") as stream:
        return list(csv.DictReader(stream))


# Plans ------------------------------------------------------------------------------------------


def test_lists_make_a_grid_and_single_values_hold_for_all(here):
    settings = ["fluid.viscosity=[2e-6, 3e-6]", "rods.ring.shape.points=[40, 50]", "time.end=0.02"]
    plan = make_plan(RING, settings, None, "sweep")
    assert [run.name for run in plan.runs] == [
        "viscosity=2e-06_points=40", "viscosity=2e-06_points=50",
        "viscosity=3e-06_points=40", "viscosity=3e-06_points=50",
    ]  # fmt: skip
    assert {run.data["time"]["end"] for run in plan.runs} == {0.02}
    assert [run.data["fluid"]["viscosity"] for run in plan.runs] == [2e-6, 2e-6, 3e-6, 3e-6]
    assert plan.key_units == {"fluid.viscosity": "g um^-1 s^-1", "rods.ring.shape.points": ""}
    assert not (here / "sweep").exists()


def test_expressions_in_lists_and_tables_are_their_numbers(here):
    """The folders, the table and the axis of a plot have numbers; a new parameter may be swept."""
    flagellum, turns = CONFIGS / "flagellum.yaml", "parameters.phi=[0, pi/2, pi]"
    plan = make_plan(flagellum, [turns, "parameters.n=3", "time.end=n*period"], None, "sweep")
    assert [run.values["parameters.phi"] for run in plan.runs] == [0, np.pi / 2, np.pi]
    assert plan.runs[1].name == "phi=1.5707963267948966"
    assert plan.runs[0].data["time"]["end"] == 3 * (2 * np.pi / 400)
    (here / "t.csv").write_text("parameters.sigma,time.end\n200,4*period\n50*pi,2*pi/sigma\n")
    runs = make_plan(flagellum, [], "t.csv", "sweep").runs
    assert [run.values["time.end"] for run in runs] == [
        4 * (2 * np.pi / 200),
        2 * np.pi / (50 * np.pi),
    ]
    assert load_case(flagellum, ["parameters.sigma=200"]).time.end == 5 * (2 * np.pi / 200)


def test_a_sweep_over_rods_like_another(here):
    two = CONFIGS / "two_flagella.yaml"
    plan = make_plan(
        two, ["rods.right.parameters.phi=[0, pi]", "rods.left.shape.points=20"], None, "s"
    )
    assert [run.data["rods"]["right"]["parameters"]["phi"] for run in plan.runs] == [0, np.pi]
    assert {run.data["rods"]["right"]["shape"]["points"] for run in plan.runs} == {20}
    plan.runs[1].prepare()
    assert load_case(plan.runs[1].case).resolved() == plan.runs[1].data


def test_entries_that_are_lists_or_mappings(here):
    settings = ["rods.ring.strain_twist=[[1.2, 0, 0.3], ['0.4*sin(s)', 0, 0.3]]",
                "fluid.epsilon=[{spacings: 5}, 0.37]"]  # fmt: skip
    runs = make_plan(RING, settings, None, "sweep").runs
    assert runs[0].data["rods"]["ring"]["strain_twist"] == [1.2, 0.0, 0.3]
    assert runs[3].data["rods"]["ring"]["strain_twist"][0] == "0.4*sin(s)"
    assert runs[3].data["fluid"]["epsilon"] == 0.37
    assert len({run.name for run in runs}) == 4
    assert all(len(run.name) < 200 and "/" not in run.name for run in runs)


def test_the_case_of_a_run_says_all_by_itself(here):
    text = Path(RING).read_text().replace("title: ", "title: 1e-3 #")
    (here / "cases").mkdir()
    (here / "cases/case.yaml").write_text(text.replace("1e-3 #", '"1e-3" #'))
    plan = make_plan("cases/case.yaml", ["time.end=[0.02]"], None, "sweep")
    plan.runs[0].prepare()
    again = load_case(plan.runs[0].case)
    assert again.resolved() == plan.runs[0].data
    assert again.title == "1e-3"


def test_shape_files_are_found_from_the_folder_of_a_run(here):
    (here / "cases").mkdir()
    shape = "{kind: file, path: rod.txt, spacing: 0.2}"
    (here / "cases/case.yaml").write_text(
        f"fluid: {{viscosity: 2e-6, epsilon: 0.3}}\nrods: {{r: {{shape: {shape},"
        " moduli: {bending: 3e-3, twisting: 2e-3, shear: 0.7, stretch: 0.9}}}\ntime: {end: 0.5}\n"
    )
    run = make_plan("cases/case.yaml", ["time.end=[0.02]"], None, "sweep").runs[0]
    assert run.data["rods"]["r"]["shape"]["path"] == str(here / "cases" / "rod.txt")


def test_a_table_has_a_run_per_row_and_meets_the_lists(here):
    (here / "t.csv").write_text("# a comment\nfluid.viscosity,time.end\n2e-6,0.02\n,0.03\n")
    plan = make_plan(RING, ["rods.ring.shape.points=[40, 50]"], "t.csv", "sweep")
    seen = [(r.data["fluid"]["viscosity"], r.data["time"]["end"]) for r in plan.runs]
    assert seen == [(2e-6, 0.02)] * 2 + [(1e-6, 0.03)] * 2


def test_only_line_ends_end_a_row(here):
    """Python's splitlines also takes form feeds and Unicode's separators for one."""
    head = "time.end,title\r\n"
    (here / "t.csv").write_bytes(f'{head}0.02,"a\u2028b"\r\n0.03,"x, y"\r\n'.encode())
    assert [where for where, _ in read_table("t.csv")] == ["t.csv:2", "t.csv:3"]
    assert read_table("t.csv")[1][1] == {"time.end": 0.03, "title": "x, y"}
    (here / "t.csv").write_text(f'{head}0.02,"a\x0cb"\n0.03,x\n')
    with pytest.raises(CaseError, match=r"t\.csv:2: title: .*U\+000C is not allowed"):
        read_table("t.csv")


def test_folders_are_apart_on_disks_that_do_not_tell_capitals():
    names = [folder_name({"title": text}) for text in ("a", "A", "aB", "Ab")]
    assert names[0] == "title=a"
    assert len({name.lower() for name in names}) == 4


def test_the_same_value_has_the_same_folder_however_it_is_written():
    for one, other in ((400, 400.0), ([1, 0.5], [1.0, 0.5]), ({"spacings": 4}, {"spacings": 4.0})):
        assert folder_name({"x.y": one}) == folder_name({"x.y": other})
    assert len({folder_name({"b": value}) for value in (1, 1.5, "1 ", True, 2.0**80, -1)}) == 6


def test_a_spreadsheet_runs_nothing_of_a_table(here):
    values = {"title": "=HYPERLINK(1)", "a": "@x", "b": "+x", "c": "-x", "d": "-1.5", "e": -2.5}
    run = replace(one(), values=values)
    summary = Summary(Plan([run], dict.fromkeys(values, "")))
    summary.write(here / "summary.csv")
    row = rows("summary.csv")[0]
    assert [row[key] for key in values] == ["'=HYPERLINK(1)", "'@x", "'+x", "'-x", "-1.5", "-2.5"]
    assert "'" not in summary.text()


def test_the_table_is_not_written_at_every_end(here, monkeypatch):
    """A thousand runs that are stopped together would write a million rows."""
    run = one()
    summary, written = Summary(Plan([run], {})), []
    monkeypatch.setattr(summary, "write", written.append)
    now = iter([10.0, 10.0, 10.5, 11.5, 11.5])
    monkeypatch.setattr("rodsim.sweep.summary.monotonic", lambda: next(now))
    for _ in range(3):
        summary.write_now_and_then("table")
    assert len(written) == 2


@pytest.mark.parametrize(
    ("settings", "table", "error", "words"),
    [
        (["rods.ring.strain_twist=[1.2, 0, 0.5]"], None, CaseError,
         "rods.ring.strain_twist = [1.2, 0, 0.5]: one run for each entry, and none is a list: "
         "write [[1.2, 0, 0.5]] for one value that is this list"),
        (["time.end=[0.02, -3]"], None, CaseError, "time.end = -3: must be > 0"),
        (["time.ende=[0.02]"], None, CaseError, "did you mean 'end'"),
        (["time.end=[]"], None, UsageError, "0 runs"),
        (["time.end=[0.02, 0.02]"], None, UsageError, "twice"),
        ([f"time.end={list(range(1, 200))}", f"fluid.epsilon={list(range(1, 200))}"], None,
         UsageError, "39601 runs: must be 1 to 10000"),
        ([], "time.end\n0.02\n-3\n", CaseError, "t.csv:3: time.end = -3: must be > 0"),
        ([], "time.end\n0.02,4\n", CaseError, "t.csv:2: has 2 cells where"),
        ([], "time.end\n", UsageError, "at least one of values"),
        (["time.end=[1, 1.0]"], None, UsageError, "the sweep has the run end=1 twice"),
        ([], "time.end\n1\n1.00\n", UsageError, "the sweep has the run end=1 twice"),
        ([], "# three\nfluid.viscosity,time.end, fluid.viscosity\n1e-6,1e-4,2e-6\n", CaseError,
         "t.csv:2: fluid.viscosity: two columns have it: column 1, column 3"),
        (["time.end=0.03"], "time.end\n0.02\n", UsageError, "set by --set and by t.csv"),
        (["time.end=0.03", "time.end=[0.02]"], None, UsageError, "a value and a list of values"),
        ([], 'time.end\n"0.02\n', CaseError, "t.csv:2: is not CSV: unexpected end"),
        (["time.end=[0.03]"], "time.end\n0.02\n", UsageError, "set by --set and by t.csv"),
    ],
)  # fmt: skip
def test_a_sweep_that_cannot_be_is_refused_before_anything_is_written(
    settings, table, error, words, here
):
    if table:
        (here / "t.csv").write_text(table)
    with pytest.raises(error, match=words.replace("[", r"\[")):
        make_plan(RING, settings, "t.csv" if table else None, "sweep")
    assert not (here / "sweep").exists()


def test_the_table_of_the_paper_ends_after_whole_periods():
    runs = make_plan(CONFIGS / "flagellum.yaml", [], SWIMMING, "sweep").runs
    assert len(runs) == 24
    for run in runs:
        periods = run.data["time"]["end"] * run.data["parameters"]["sigma"] / (2 * np.pi)
        assert periods == pytest.approx(4.0, rel=1e-9)


# What a run has come to -------------------------------------------------------------------------


def one(settings=()):
    changes = [text for text in SHORT if text != "--set"]
    plan = make_plan(RING, [*changes, "rods.ring.strain_twist=[[1.2, 0, 0.6]]", *settings],
                     None, "sweep")  # fmt: skip
    plan.runs[0].prepare()
    return plan.runs[0]


def test_only_the_same_case_counts(here):
    run = one()
    assert standing(run) == "waiting"
    assert work("token", run, None)[0] == 0
    assert standing(run) == "finished"
    assert command(run, "stopped")[-2:] == ["resume", str(run.output)]
    other = one(["time.tolerance=1e-5"])
    assert other.folder == run.folder
    assert standing(other) == "waiting"
    assert work("token", other, None)[0] == 0  # what was there is renamed, not lost
    assert standing(other) == "finished"
    shutil.move(other.folder / "out.1.h5", run.output)
    assert standing(run) == "finished"
    run.output.write_text("not an output")
    assert standing(run) == "waiting"


def test_an_output_that_is_being_written_is_waited_for(here, monkeypatch):
    """As after a worker was killed and its run was not: for ever, if the system says it lives."""
    run = one()
    lock = OutputLock(run.output)
    lock.acquire()
    monkeypatch.setattr("rodsim.sweep.work.PATIENCE", 0.0)
    threading.Timer(1.0, lock.release).start()
    assert work("token", run, None)[0] == 0
    assert standing(run) == "finished"


def test_a_machine_that_may_have_vanished_is_waited_for_a_while(here, monkeypatch):
    run = one()
    lock = run.output.with_name("out.h5.lock")
    lock.write_text('{"host": "elsewhere", "boot": "another machine", "pid": 4}')
    monkeypatch.setattr("rodsim.sweep.work.PATIENCE", 0.3)
    code, said = work("token", run, None)
    assert code == 4
    assert "is being done by process 4 on elsewhere" in said
    assert f"remove {run.lock} and {lock}" in said


def test_a_run_that_another_worker_does_is_not_done_again(here):
    """Two sweeps in one folder: whoever comes second finds it finished."""
    run = one()
    codes = []
    others = [
        threading.Thread(target=lambda s=sweep: codes.append(work(s, run, None)[0]))
        for sweep in ("one", "other")
    ]
    for thread in others:
        thread.start()
    for thread in others:
        thread.join()
    assert codes == [0, 0]
    assert run.log.read_text().count("$ ") == 1
    assert sorted(os.listdir(run.folder)) == ["case.yaml", "out.h5", "run.log"]


def test_a_run_under_way_has_no_numbers(here):
    """Half-way ones would be taken for results."""
    run = one()
    case = load_case(run.case)
    seen = []

    def look():
        if not seen:
            seen.append(dict(Summary(Plan([run], {})).rows[run.name]))
        return ""

    simulate(case, run.output, stop=look)
    assert seen == [{"run": run.name, **run.values, "status": "running"}]
    assert Summary(Plan([run], {})).rows[run.name]["elastic_energy"] > 0.0


def test_list_prints_what_is_left_and_a_shell_can_run_it(here):
    arguments = ("sweep", RING, *SHORT, "--set", "time.tolerance=[1e-3, 1e-4]")
    lines = call(*arguments, "--list").stdout.splitlines()
    assert len(lines) == 2
    subprocess.run(["sh", "-c", lines[0]], check=True, capture_output=True)
    assert call(*arguments, "--list").stdout.splitlines() == lines[1:]


def test_a_sweep_runs_then_skips_then_draws(here, monkeypatch):
    """Here, without a scheduler, the standard library is all it takes."""
    pytest.importorskip("matplotlib")
    for name in ("dask", "distributed", "rich"):
        monkeypatch.setitem(sys.modules, name, None)
    arguments = ("sweep", RING, *SHORT, "--set", "time.tolerance=[1e-3, 1e-5]")
    first = call(*arguments)
    assert first.exit_code == 0, first.stderr
    assert "tolerance=0.001: finished" in first.stderr
    assert [row["status"] for row in rows()] == ["finished", "finished"]
    with open_trajectory("sweep/tolerance=1e-05/out.h5") as run:
        centre = run.position.mean(axis=1)
        velocity = np.polyfit(run.time, centre, 1)[0]
        energy = sum(run.observable(f"{p}_energy", -1)[0]
                     for p in ("bending", "twisting", "shear", "stretch"))  # fmt: skip
        assert float(rows()[1]["speed (um s^-1)"]) == pytest.approx(np.hypot.reduce(velocity))
        assert float(rows()[1]["elastic_energy (g um^2 s^-2)"]) == pytest.approx(energy)
    written = (here / "sweep/tolerance=0.001/out.h5").stat().st_mtime_ns
    again = call(*arguments, "--reference", "sweep/tolerance=1e-05/out.h5",
                 "--plot", "tolerance", "error", "error.png")  # fmt: skip
    assert again.exit_code == 0
    assert (here / "sweep/tolerance=0.001/out.h5").stat().st_mtime_ns == written
    assert [float(row["error (um)"]) > 0 for row in rows()] == [True, False]
    assert (here / "error.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_what_fails_or_diverges_is_reported_and_left(here):
    """A step above its limit is refused, so that run has no output until it is forced."""
    text = Path(RING).read_text().replace("tolerance: 1.0e-4", "integrator: euler")
    (here / "case.yaml").write_text(text)
    arguments = ("sweep", "case.yaml", *SHORT, "--set", "time.end=0.02",
                 "--set", "output.interval=1e-3", "--set", "time.step=[1e-4]")  # fmt: skip
    first = call(*arguments)
    assert first.exit_code == 4
    assert first.stderr.splitlines()[-1] == "1 failed"
    assert rows()[0]["status"] == "failed"
    assert "above the largest stable step" in rows()[0]["message"]
    log = here / "sweep/step=0.0001/run.log"
    with log.open("a") as stream:
        line = shlex.split(log.read_text().splitlines()[0].removeprefix("$ "))
        assert subprocess.run([*line, "--force"], stderr=stream).returncode == 3
    again = call(*arguments)
    assert again.exit_code == 3
    assert rows()[0]["status"] == "diverged"
    assert rows()[0]["message"].startswith("diverged in step")


def test_a_wrong_period_column_or_scheduler_is_told_before_the_runs(here, monkeypatch):
    monkeypatch.setattr("rodsim.sweep.cluster.CONNECT_SECONDS", 1)
    arguments = ("sweep", RING, *SHORT, "--set", "time.tolerance=[1e-3, 1e-4]")
    for extra, words in (
        (("--period", "2*pi/sigma"), "sigma"),
        (("--plot", "tolerance", "sped", "x.png"), "no column sped"),
        (("--scheduler", "tcp://127.0.0.1:9"), "cannot be reached"),
    ):
        result = call(*arguments, *extra)
        assert result.exit_code == 2
        assert words in result.stderr


# Workers that are killed ------------------------------------------------------------------------


@contextmanager
def real_cluster(folder):
    """A scheduler and two workers, each a process of its own; yields (address, workers)."""
    file = folder / "scheduler.json"
    dask = [sys.executable, "-m", "distributed.cli.dask_"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": folder}
    start = [*dask[:2], dask[2] + "scheduler", "--scheduler-file", str(file), "--no-dashboard",
             "--host", "127.0.0.1", "--port", "0"]  # fmt: skip
    serve = [*dask[:2], dask[2] + "worker", "--scheduler-file", str(file), "--no-nanny",
             "--nthreads", "1", "--no-dashboard"]  # fmt: skip
    processes = [subprocess.Popen(start, **quiet)]
    try:
        wait_for(file.exists, *processes)
        processes += [subprocess.Popen(serve, **quiet) for _ in range(2)]
        yield json.loads(file.read_text())["address"], processes[1:]
    finally:
        for process in processes:
            process.kill()
            process.wait()


def wait_for(condition, *processes):
    """Wait, however busy the machine is, until a condition holds that these will bring about."""
    while not condition():
        assert all(process.poll() is None for process in processes), "ended too early"
        time.sleep(0.05)


def run_of(worker):
    """Return the process that does a Dask worker's runs, with the output it is at, or None."""
    import psutil

    for child in psutil.Process(worker.pid).children():
        for lock in Path("sweep").glob("*/out.h5.lock"):
            with suppress(OSError, ValueError):  # it is just ending
                if json.loads(lock.read_text())["pid"] == child.pid:
                    return child, lock.with_suffix("")
    return None


def well_begun(worker):
    """Whether a worker's run has written some frames, but not all of them."""
    found = run_of(worker)
    if not found:
        return False
    try:
        with open_trajectory(found[1]) as run:
            return 3 <= run.frames < len(run.planned)
    except Exception:  # not there yet
        return False


def start_and_kill_one(arguments, address, workers):
    """Start a sweep, kill a worker and its run in the middle; return (output killed, result)."""
    sweep = [sys.executable, "-m", "rodsim", "sweep", *map(str, arguments), "--scheduler", address]
    with subprocess.Popen(sweep, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as p:
        wait_for(lambda: well_begun(workers[0]), p)
        process, output = run_of(workers[0])
        workers[0].kill()
        process.kill()
        p.communicate()
    return output, p.returncode


@pytest.mark.compiled
def test_a_killed_worker_loses_nothing(here):
    """Its run is resumed by the other worker, to the same bits as a run that nobody disturbed."""
    slow = ("--set", "rods.ring.shape.points=[60, 64]", "--set", "time.tolerance=1e-9")
    with real_cluster(here) as (address, workers):
        killed, code = start_and_kill_one((RING, *slow), address, workers)
    assert code == 0
    assert [row["status"] for row in rows()] == ["finished"] * 2
    folder = (here / killed).parent
    assert "rodsim resume" in (folder / "run.log").read_text()
    undisturbed = call("run", folder / "case.yaml", "-o", "alone.h5", "-q")
    assert undisturbed.exit_code == 0
    with open_trajectory(killed) as run, open_trajectory("alone.h5") as alone:
        assert np.array_equal(run.position, alone.position)
        assert np.array_equal(run.director, alone.director)


@pytest.mark.compiled
def test_ctrl_c_stops_the_runs_and_the_same_command_goes_on(here):
    arguments = [
        "sweep",
        RING,
        "--set",
        "rods.ring.shape.points=[60, 64, 68]",
        "--set",
        "time.max_step=1e-8",
        "-j",
        "2",
    ]  # fmt: skip  (an hour each)
    with subprocess.Popen(
        [sys.executable, "-m", "rodsim", *arguments],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    ) as sweep:  # fmt: skip
        wait_for(lambda: len(list(here.glob("sweep/*/out.h5"))) == 2, sweep)
        sweep.send_signal(signal.SIGINT)
        _, said = sweep.communicate()
    assert sweep.returncode == 75
    assert "Traceback" not in said
    assert not list(here.glob("sweep/*/out.h5.lock"))
    states = sorted(row["status"] for row in rows())
    assert states == ["stopped", "stopped", "waiting"]
    lines = call(*arguments, "--list").stdout.splitlines()
    assert sum(" resume " in line for line in lines) == 2
    assert sum(" run " in line for line in lines) == 1


@pytest.mark.compiled
def test_runs_end_with_a_sweep_that_is_killed(here):
    arguments = ["sweep", RING, "--set", "rods.ring.shape.points=[60, 64]",
                 "--set", "time.tolerance=1e-11", "-j", "2"]  # fmt: skip
    with subprocess.Popen(
        [sys.executable, "-m", "rodsim", *arguments],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    ) as sweep:  # fmt: skip
        wait_for(lambda: len(list(here.glob("sweep/*/out.h5"))) == 2)
        sweep.kill()
    outputs = list(here.glob("sweep/*/out.h5"))
    wait_for(lambda: not any(writing_process(path) for path in outputs))
    for path in outputs:
        with open_trajectory(path) as run:
            assert run.status == "stopped"
        assert "stopped by the end of the sweep" in (path.parent / "run.log").read_text()


@pytest.mark.long
@pytest.mark.compiled
def test_a_scheduler_that_dies_is_told_in_a_line(here):
    slow = ("--set", "rods.ring.shape.points=[60, 64, 68]", "--set", "time.tolerance=1e-11")
    with real_cluster(here) as (address, workers):
        line = [sys.executable, "-m", "rodsim", "sweep", RING, *slow, "--scheduler", address]
        with subprocess.Popen(
            line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        ) as sweep:
            wait_for(lambda: sweep.poll() is not None or all(map(well_begun, workers)))
            assert sweep.poll() is None
            scheduler_of(workers).kill()
            _, said = sweep.communicate(timeout=120)
    assert sweep.returncode == 75
    assert said == "the scheduler is gone; on another one the same command goes on\n"
    states = sorted(row["status"] for row in rows())
    assert states[-1] == "waiting"
    assert set(states[:2]) <= {"running", "stopped"}


def scheduler_of(workers):
    import psutil

    for process in psutil.Process().children():
        if process.pid not in [w.pid for w in workers] and "dask_scheduler" in str(
            process.cmdline()
        ):
            return process
    raise AssertionError("no scheduler")


@pytest.mark.long
@pytest.mark.paper
@pytest.mark.compiled
def test_swimming_speed_over_amplitude_and_frequency(here):
    """Fig. 6: 24 cases on two workers, one of them killed.

    The infinite regularised filament swims at V = 0.340 k sigma b^2/2 while b is small (eps =
    0.4667 um); finite rods approach that from below, one of 8 wavelengths has at least 0.28. The
    rod follows its preferred shape at once, so V is in proportion to sigma at any b: 2 % are the
    lag of a bending rate of 1e4 1/s behind 250-550 rad/s.
    """
    arguments = (CONFIGS / "flagellum.yaml", "--table", SWIMMING, "--set", "output.interval=null",
                 "--period", "2*pi/sigma")  # fmt: skip
    with real_cluster(here) as (address, workers):
        _, code = start_and_kill_one(arguments, address, workers)
    assert code == 0
    table = rows()
    assert [row["status"] for row in table] == ["finished"] * 24
    factors = {}
    for row in table:
        b, sigma = float(row["parameters.b"]), float(row["parameters.sigma"])
        factor = float(row["velocity_z (um s^-1)"]) / (0.5 * K * sigma * b**2)
        factors.setdefault(b, []).append(factor)
    assert all(0.28 < factor < 0.34 for factor in factors[0.075])
    for values in factors.values():
        assert values == pytest.approx([values[0]] * 4, rel=0.03)


def test_series_name_lines_by_what_does_not_follow_from_x(here):
    (here / "t.csv").write_text("fluid.viscosity,time.end\n2e-6,0.02\n3e-6,0.03\n")
    plan = make_plan(RING, ["rods.ring.shape.points=[40, 50]"], "t.csv", "sweep")
    summary = Summary(plan)
    for row in summary.rows.values():
        row["speed"] = 5.0
    assert set(series(summary, "fluid.viscosity", "speed")[2]) == {"points = 40", "points = 50"}
    lines = series(summary, "rods.ring.shape.points", "speed")[2]
    unit = "g µm⁻¹ s⁻¹"
    assert set(lines) == {f"viscosity = 2e-06 {unit}", f"viscosity = 3e-06 {unit}"}
