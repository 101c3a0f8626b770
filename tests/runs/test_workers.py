"""Workers of a sweep: processes that stay, and what becomes of others where one ends."""

import json
import os
import signal
import subprocess
import sys
from concurrent.futures import Future
from pathlib import Path
from types import SimpleNamespace

import pytest

from rodsim.commands import serve
from rodsim.processes import usable_cores
from rodsim.sweep import local, workers
from rodsim.sweep.local import Local, share
from rodsim.sweep.schedule import ATTEMPTS, Sweep

SWEEP = "the sweep of these tests"
WRONG = ["validate", "none.yaml"]  # exit code 2, and a line


@pytest.fixture
def do(tmp_path, monkeypatch):
    """Do a command by a worker; returns its exit code. The workers go at the end."""
    monkeypatch.chdir(tmp_path)

    def order(*arguments, alone=False):
        with open("run.log", "ab", buffering=0) as log:
            return workers.do(SWEEP, 2, list(arguments), log, alone)

    yield order
    workers.dismiss(SWEEP)


def free():
    return [worker._process.pid for worker in workers._free[SWEEP, 2]]


def test_one_worker_does_all_that_comes_one_after_another(do):
    assert do(*WRONG) == 2
    first = free()
    assert do("schema") == 0
    assert free() == first
    assert len(first) == 1
    said = Path("run.log").read_text()
    assert "none.yaml: cannot read" in said
    assert json.loads(said.split("\n", 1)[1])["title"]  # the schema: what both streams say


def test_isolated_each_command_has_a_process_of_its_own(do):
    assert do(*WRONG, alone=True) == 2
    assert free() == []


def test_where_a_worker_is_killed_the_next_run_gets_another(do):
    assert do(*WRONG) == 2
    killed = free()
    os.kill(killed[0], signal.SIGKILL)
    assert do(*WRONG) == -signal.SIGKILL
    assert do(*WRONG) == 2
    assert free() != killed


def test_an_error_that_nobody_foresaw_ends_a_command_and_no_worker(tmp_path, monkeypatch):
    def wrong(*arguments, **words):
        raise ZeroDivisionError("nobody foresaw this")

    monkeypatch.setattr(serve, "cli", SimpleNamespace(main=wrong))
    streams = [os.dup(number) for number in (1, 2)]
    try:
        assert serve._do(["run"], str(tmp_path / "log")) == 1
    finally:
        for number, stream in zip((1, 2), streams, strict=True):
            os.dup2(stream, number)
            os.close(stream)


def test_a_worker_without_orders_ends_and_the_order_that_comes_too_late_is_done(
    tmp_path, monkeypatch
):
    quick = "import sys; from rodsim.commands import serve; serve.IDLE_SECONDS = 0.01"
    line = [sys.executable, "-c", f"{quick}; sys.exit(serve.main())"]
    with subprocess.Popen(line, stdin=subprocess.PIPE) as process:
        assert process.wait() == workers.IDLE
    codes = iter([workers.IDLE, 0])

    class Late:
        alive = False

        def __init__(self, threads, log):
            pass

        def do(self, arguments, log):
            return next(codes)

        def dismiss(self):
            pass

    monkeypatch.setattr(workers, "Worker", Late)
    with open(tmp_path / "log", "wb") as log:
        assert workers.do(SWEEP, 2, WRONG, log, False) == 0


# The engine of this machine, without processes --------------------------------------------------


class Runs:
    """Stands for ``work``: what each run comes to is known, and who has asked is kept."""

    def __init__(self, monkeypatch, ends):
        self.ends, self.begun, self.ended = ends, [], {}
        monkeypatch.setattr(local.work, "work", self.work)

    def work(self, sweep, run, threads, alone):
        self.begun.append(run.name)
        end = self.ends[run.name]
        if isinstance(end, Exception):
            raise end
        return end, f"said by {run.name}"

    def finish(self, jobs=2):
        runs = [SimpleNamespace(name=name) for name in self.ends]
        shown = SimpleNamespace(look=lambda: None, say=lambda text: None)
        with Local(jobs, 1, False) as engine:
            sweep = Sweep(engine, lambda r, f: self.ended.update({r.name: f}), None, lambda: False)
            sweep.finish(runs, shown)


def test_what_one_run_comes_to_is_not_that_of_another(monkeypatch):
    ends = {"done": 0, "killed": -9, "wrong": 2, "diverged": 3, "bug": ValueError("a\nb"), "too": 0}
    runs = Runs(monkeypatch, ends)
    runs.finish()
    told = {"wrong": "said by wrong", "bug": "ValueError: a"}
    assert runs.ended == {name: told.get(name) for name in ends}
    assert runs.begun.count("killed") == ATTEMPTS
    assert len(runs.begun) == len(ends) - 1 + ATTEMPTS


def test_runs_that_are_taken_back_are_not_begun(monkeypatch):
    runs = Runs(monkeypatch, {"late": 0})
    engine = Local(1, 1, False)
    future = engine.submit(SWEEP, SimpleNamespace(name="late"), 1)
    engine.cancel([future])
    with engine:
        (ended,) = engine.ended({future: None}, 60.0)
    assert ended is future
    assert future.cancelled()
    assert runs.begun == []
    assert engine.ended({Future(): None}, 0.0) == []


def test_the_machine_is_filled(monkeypatch):
    monkeypatch.setattr(local, "usable_cores", lambda: 8)
    assert share(100, None, None) == (8, 1)
    assert share(3, None, None) == (3, 2)
    assert share(100, None, 4) == (2, 4)
    assert share(100, 5, None) == (5, 1)
    assert share(1, None, 16) == (1, 16)


@pytest.mark.parametrize(
    ("files", "cores"),
    [
        ({"cpu.max": "250000 100000\n"}, 3),
        ({"cpu.max": "max 100000\n"}, 5),
        ({"cpu/cpu.cfs_quota_us": "150000\n", "cpu/cpu.cfs_period_us": "100000\n"}, 2),
        ({"cpu/cpu.cfs_quota_us": "-1\n", "cpu/cpu.cfs_period_us": "100000\n"}, 5),
        ({"cpu.max": "900000 100000\n"}, 5),
        ({}, 5),
    ],
)
def test_cores_are_those_of_the_container(files, cores, tmp_path, monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: set(range(5)), raising=False)
    (tmp_path / "cpu").mkdir()
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    assert usable_cores(tmp_path) == cores
