"""What is said beside the results can be lost; a run and its results cannot."""

import json
import os
import subprocess
import sys
import time

import pytest
from interrupted import PLANAR, make

from rodsim import open_trajectory

needs_full = pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
RODSIM = f"{sys.executable} -m rodsim"


def shell(folder, line):
    return subprocess.run(
        ["sh", "-c", line], cwd=folder, capture_output=True, text=True, check=False
    )


@pytest.mark.parametrize(
    "sink", [pytest.param("2>/dev/full", marks=needs_full), "2>&-", "<&- 2>&-"]
)
def test_a_run_goes_on_without_its_log(tmp_path, sink):
    make(tmp_path, PLANAR)
    done = shell(tmp_path, f"{RODSIM} run case.yaml {sink}")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    with open_trajectory(tmp_path / "out.h5") as run:
        assert run.status == "finished"


@needs_full
def test_a_result_that_is_lost_is_told_all_the_same(tmp_path):
    make(tmp_path, PLANAR)
    for sink in ("2>&1", "2>/dev/null"):
        assert shell(tmp_path, f"{RODSIM} schema >/dev/full {sink}").returncode == 4
    assert "could not be written" in shell(tmp_path, f"{RODSIM} schema >/dev/full").stderr
    wrong = shell(tmp_path, f"{RODSIM} validate none.yaml 2>/dev/full")
    assert wrong.returncode == 2


def test_no_file_gets_the_number_of_a_closed_stream(tmp_path):
    """Else what a library says on standard error goes into the output."""
    code = (
        "from rodsim.streams import prepare_streams; prepare_streams()\n"
        "import os; os.write(2, b'lost'); print(open('out.h5', 'w').fileno())"
    )
    done = shell(tmp_path, f'{sys.executable} -c "{code}" <&- 2>&-')
    assert int(done.stdout) > 2
    assert (tmp_path / "out.h5").read_bytes() == b""


WAITING = """
import os, sys, threading, time
from pathlib import Path
from rodsim.compiled.settings import prepare
prepare()
from rodsim.run.watch import Watch
import rodsim.run.stopping
from {program} import main
check = Watch.check
def wait(self, step):
    if step.number == 20:
        Path("here").touch()
        while {condition}:
            time.sleep(0.01)
    return check(self, step)
Watch.check = wait
main()
"""


def waiting(folder, condition, program="rodsim.__main__"):
    """Return the command of a run that waits in its twentieth step while something is so."""
    make(folder, PLANAR)
    return [
        sys.executable,
        "-c",
        WAITING.format(condition=condition, program=program),
        "run",
        "case.yaml",
    ]


def until_it_waits(folder):
    for _ in range(6000):
        if (folder / "here").exists():
            return
        time.sleep(0.01)
    raise AssertionError("waited in vain")


def assert_stopped(path):
    with open_trajectory(path) as run:
        assert run.status == "stopped"
        assert run.steps[-1] <= 20
        assert run.checkpoint() is not None


def test_a_run_stops_with_who_has_started_it(tmp_path):
    """A sweep that is killed ends the pipe; the run goes no further than the step it is in."""
    line = waiting(tmp_path, "not rodsim.run.stopping._for_all", "rodsim.commands.serve")[:3]
    order = json.dumps([["run", "case.yaml"], "run.log"])
    with subprocess.Popen(
        line, cwd=tmp_path, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        process.stdin.write(f"{order}\n")
        process.stdin.flush()
        until_it_waits(tmp_path)
        answer, _ = process.communicate(timeout=60)  # closes its standard input
    assert (answer, process.returncode) == ("75\n", 0)
    said = (tmp_path / "run.log").read_text()
    assert "stopped by the end of the sweep that started it at t = " in said
    assert_stopped(tmp_path / "out.h5")


def test_a_terminal_that_is_closed_stops_a_run_in_order(tmp_path):
    """The system then sends SIGHUP, and nothing can be said any more."""
    pty = pytest.importorskip("pty")
    line = waiting(tmp_path, "os.isatty(2)")
    pid, terminal = pty.fork()
    if pid == 0:
        os.chdir(tmp_path)
        os.execv(line[0], line)
    until_it_waits(tmp_path)
    os.close(terminal)
    _, status = os.waitpid(pid, 0)
    assert os.waitstatus_to_exitcode(status) == 75
    assert_stopped(tmp_path / "out.h5")
