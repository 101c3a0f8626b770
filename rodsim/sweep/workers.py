"""Processes that stay and do one command after another, each for one run at a time.

What a run needs is imported, and its compiled code loaded, once a worker and not once a run. A
command that ends its worker, a crash or a kill, ends nothing else: the next run gets another one.
"""

from __future__ import annotations

import json
import os
import subprocess
import threading
from collections import defaultdict
from contextlib import suppress

from rodsim.processes import this_rodsim

SERVE = "rodsim.commands.serve"
IDLE = 76  # the exit code of a worker that had no orders for long: the next was not begun
_guard = threading.Lock()
_free: dict[tuple[str, int | None], list[Worker]] = defaultdict(list)  # by sweep and threads
_busy: list[tuple[str, Worker]] = []  # (sweep, the worker that is at one of its runs)


class Worker:
    """One such process."""

    def __init__(self, threads: int | None, log):
        """``threads`` of each run; what goes wrong before the first one is said in its log."""
        environment = {"NUMBA_NUM_THREADS": "1", **os.environ}  # a worker stands for a core
        if threads:
            environment["NUMBA_NUM_THREADS"] = str(threads)
        # A session of its own: Ctrl-C on the terminal reaches the sweep, which then stops the runs.
        # Its standard input ends with this process, however that ends, and the run then stops.
        self._process = subprocess.Popen(
            this_rodsim(SERVE), stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log,
            env=environment, start_new_session=True,
        )  # fmt: skip

    def do(self, arguments: list[str], log: str) -> int:
        """Do a command; return its exit code, below 0 the signal that has ended the process."""
        with suppress(BrokenPipeError):  # has ended: so says its exit code
            self._process.stdin.write(json.dumps([arguments, log]).encode() + b"\n")
            self._process.stdin.flush()
        answer = self._process.stdout.readline()
        return int(answer) if answer else self._process.wait()

    @property
    def alive(self) -> bool:
        """Whether the process can have another order."""
        return self._process.poll() is None

    def stop(self) -> None:
        """Ask the run to stop. SIGTERM and not SIGINT: it also ends a run that is starting."""
        self._process.terminate()

    def dismiss(self) -> None:
        """Order no more: the process ends, after the step that a run is in."""
        with suppress(BrokenPipeError):
            self._process.stdin.close()

    def wait(self) -> None:
        """Wait for the end of the process, so that nothing of it stays behind."""
        self._process.wait()


def do(sweep: str, threads: int | None, arguments: list[str], log, alone: bool) -> int:
    """Do a command for a sweep, ``alone`` in a process of its own; return its exit code."""
    while True:
        worker = _take(sweep, threads, log)
        code = None
        try:
            code = worker.do(arguments, log.name)
        finally:
            _give_back(sweep, threads, worker, stays=code is not None and not alone)
        if code != IDLE:
            return code


def stop(sweep: str) -> None:
    """Ask all runs of a sweep to stop where they are, each once."""
    with _guard:
        for entry in [entry for entry in _busy if entry[0] == sweep]:
            _busy.remove(entry)
            entry[1].stop()


def dismiss(sweep: str) -> None:
    """Let the workers of a sweep go: it has no more runs. Returns when they have ended."""
    with _guard:
        workers = [worker for key in list(_free) if key[0] == sweep for worker in _free.pop(key)]
    for worker in workers:
        worker.dismiss()
    for worker in workers:
        worker.wait()


def _take(sweep, threads, log):
    with _guard:
        free = _free[sweep, threads]
        worker = free.pop() if free else Worker(threads, log)
        _busy.append((sweep, worker))
    return worker


def _give_back(sweep, threads, worker, stays):
    with _guard:
        if (sweep, worker) in _busy:
            _busy.remove((sweep, worker))
        if stays and worker.alive:
            _free[sweep, threads].append(worker)
            return
    worker.dismiss()
