"""The runs of a study: each once, however many rows ask for it, side by side where that pays."""

from __future__ import annotations

import json
import os
import signal
import threading
from concurrent.futures import Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field, replace
from multiprocessing import active_children, get_context, parent_process
from typing import Any

from rodsim.compiled.constants import GPU
from rodsim.compiled.settings import prepare
from rodsim.errors import CaseError, DivergedError
from rodsim.processes import usable_cores

WORTHWHILE = 5.0  # s of one core: below that, other processes take longer to start than they save
PAIR_SECONDS = 1.5e-9  # one pair of the sums on one core
LOOK_SECONDS = 0.5
REFUSED, DIVERGED = "refused", "diverged"


@dataclass
class Asked:
    """A run that rows have asked for. ``weight``: pairs of its sums; ``done``: part of them."""

    label: str
    case: Any
    nudged: bool
    repeats: int
    weight: float
    done: float = 0.0
    found: Any = field(default=None, repr=False)  # an outcome, or in words why there is none


def attempt(case, threads, repeats, nudged, progress=lambda fraction: None):
    """Return the outcome of a run, or in words why there is none."""
    from rodsim.convergence.outcome import solve

    try:
        return solve(case, threads, repeats, progress=progress, nudged=nudged)
    except CaseError as error:
        return f"{REFUSED}: {error.problems[0].reason}"
    except DivergedError as error:
        return f"{DIVERGED}: {str(error).splitlines()[0]}"


def _attempt_elsewhere(case, threads, repeats, nudged):
    """Return what ``attempt`` does, without the scene: its parts are of the process they are in."""
    found = attempt(case, threads, repeats, nudged)
    return found if isinstance(found, str) else replace(found, scene=None)


class Runs:
    """All runs of a study. A context manager; ``progress.update(fraction, label)`` hears of them.

    ``ask`` for all first: where the work is worth it and cores are free, they go on side by side
    from the moment one ``outcome`` is wanted, the longest first.
    """

    def __init__(self, threads: int | None, progress=None):
        self.threads, self.progress = threads, progress
        self._asked: dict[tuple[str, bool], Asked] = {}
        self._pool: ProcessPoolExecutor | None = None
        self._futures: dict[int, Future] = {}
        self._others: set = set()  # processes of whoever calls

    def __enter__(self):
        return self

    def __exit__(self, *error):
        if self._pool:
            self._pool.shutdown(wait=False, cancel_futures=True)
            for process in {*active_children()} - self._others:
                process.terminate()

    def ask(self, label: str, case, weight: float, nudged=False, repeats=1) -> None:
        """Ask for the run of a case; one that was asked for already is the same."""
        asked = Asked(label, case, nudged, repeats, weight)
        known = self._asked.setdefault(_key(case, nudged), asked)
        known.repeats = max(known.repeats, repeats)

    @property
    def side_by_side(self) -> int:
        """How many runs go on at once; each is then on ``threads`` threads, or on one."""
        if any(run.case.device == GPU for run in self._asked.values()):
            return 1  # on one card they would only wait for each other, and be timed so
        seconds = PAIR_SECONDS * sum(run.weight for run in self._asked.values())
        most = min(usable_cores() // (self.threads or 1), len(self._asked))
        return most if most > 1 and seconds > WORTHWHILE else 1

    def outcome(self, case, nudged=False):
        """Return the outcome of a run that was asked for, or in words why there is none."""
        run = self._asked[_key(case, nudged)]
        if run.found is None and self.side_by_side == 1:
            run.found = attempt(case, self.threads, run.repeats, nudged, self._progress_of(run))
        elif run.found is None:
            run.found = self._from_elsewhere(run)
        run.done = 1.0
        return run.found

    def _progress_of(self, run):
        def tick(fraction):
            run.done = fraction
            self._tell(run.label)

        return tick

    def _tell(self, label):
        if self.progress:
            runs = self._asked.values()
            done = sum(run.done * run.weight for run in runs) / sum(run.weight for run in runs)
            self.progress.update(min(1.0, done), label)

    def _from_elsewhere(self, run):
        if not self._pool:
            self._start()
        future = self._futures[id(run)]
        while not future.done():
            wait([future], LOOK_SECONDS)
            for other in self._asked.values():
                other.done = float(self._futures[id(other)].done())
            self._tell(run.label)
        try:
            found = future.result()
        except BrokenProcessPool:
            return "stopped: a process of the study was killed; is there memory enough?"
        if isinstance(found, str):
            return found
        from rodsim.scene.build import build_scene

        return replace(found, scene=build_scene(run.case))

    def _start(self):
        """Start as many processes as there are cores free, and give them the longest runs first."""
        self._others = {*active_children()}
        context = get_context("spawn")  # a forked one could not use the threads that are there
        self._pool = ProcessPoolExecutor(self.side_by_side, context, initializer=_begin)
        for run in sorted(self._asked.values(), key=lambda run: -run.weight):
            words = run.case, self.threads or 1, run.repeats, run.nudged
            self._futures[id(run)] = self._pool.submit(_attempt_elsewhere, *words)


def _begin():
    """Prepare a process of a study: Ctrl-C is for the study, and without it there is no work."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_the_study, daemon=True).start()
    prepare()


def _end_with_the_study():
    parent_process().join()
    os._exit(1)


def _key(case, nudged):
    return json.dumps(case.resolved(), sort_keys=True), nudged
