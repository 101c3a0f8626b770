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
HEARD = 500  # times at most that the progress of a run is told
REFUSED, DIVERGED = "refused", "diverged"


@dataclass
class Asked:
    """A run that rows have asked for. ``weight``: pairs of its sums; ``done``: part of them."""

    label: str
    case: Any
    twin: bool
    repeats: int
    weight: float
    done: float = 0.0
    found: Any = field(default=None, repr=False)  # an outcome, or in words why there is none


def attempt(case, threads, repeats, twin, progress=lambda fraction: None):
    """Return the outcome of a run, or in words why there is none."""
    from rodsim.convergence.outcome import solve

    try:
        return solve(case, threads, repeats, progress=progress, twin=twin)
    except CaseError as error:
        return f"{REFUSED}: {error.problems[0].reason}"
    except DivergedError as error:
        return f"{DIVERGED}: {str(error).splitlines()[0]}"


def _attempt_elsewhere(case, threads, repeats, twin):
    """Return what ``attempt`` does, without the scene: its parts are of the process they are in."""
    found = attempt(case, threads, repeats, twin)
    return found if isinstance(found, str) else replace(found, scene=None)


class Runs:
    """All runs of a study. A context manager; ``progress.update(fraction, label)`` hears of them.

    ``ask`` for all first: where the work is worth it and cores are free, they go on side by side
    from the moment one ``outcome`` is wanted: that one here, and the longest others in processes
    of their own. Here goes on whatever none of them has begun.
    """

    def __init__(self, threads: int | None, progress=None):
        self.threads, self.progress = threads, progress
        self._asked: dict[str, Asked] = {}
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

    def ask(self, label: str, case, weight: float, twin=False, repeats=1) -> None:
        """Ask for the run of a case; one that was asked for already is the same.

        ``twin``: that of ``outcome.solve``, ``repeats`` too.
        """
        asked = Asked(label, case, twin, repeats, weight)
        known = self._asked.setdefault(_key(case), asked)
        known.repeats, known.twin = max(known.repeats, repeats), known.twin or twin

    @property
    def side_by_side(self) -> int:
        """How many runs go on at once; each is then on ``threads`` threads, or on one."""
        if any(run.case.device == GPU for run in self._asked.values()):
            return 1  # on one card they would only wait for each other, and be timed so
        seconds = PAIR_SECONDS * sum(run.weight for run in self._asked.values())
        most = min(usable_cores() // (self.threads or 1), len(self._asked))
        return most if most > 1 and seconds > WORTHWHILE else 1

    def outcome(self, case):
        """Return the outcome of a run that was asked for, or in words why there is none."""
        run = self._asked[_key(case)]
        if not self._pool and self.side_by_side > 1:
            self._start(first=run)
        while run.found is None:
            if mine := self._next_here(run):
                self._make(mine)
            else:
                self._look_at(run)
        run.done = 1.0
        return run.found

    def _next_here(self, wanted):
        """Return what to run here, ``wanted`` or the longest other; None where all is begun."""
        others = [run for run in self._by_length() if run.found is None]
        return next((run for run in (wanted, *others) if self._is_mine(run)), None)

    def _is_mine(self, run):
        future = self._futures.get(id(run))
        return future is None or future.cancel()

    def _make(self, run):
        threads = self.threads if self.side_by_side == 1 else self.threads or 1
        run.found = attempt(run.case, threads, run.repeats, run.twin, self._progress_of(run))
        run.done = 1.0

    def _progress_of(self, run):
        def tick(fraction):
            if fraction > run.done + 1.0 / HEARD:
                run.done = fraction
                self._tell(run.label)

        return tick

    def _tell(self, label):
        if self.progress:
            runs = self._asked.values()
            done = sum(run.done * run.weight for run in runs) / sum(run.weight for run in runs)
            self.progress.update(min(1.0, done), label)

    def _look_at(self, run):
        """Wait a moment for a run that another process has begun; take over what it found."""
        future = self._futures[id(run)]
        wait([future], LOOK_SECONDS)
        for other in self._asked.values():
            other.done = max(other.done, float(self._is_done_elsewhere(other)))
        self._tell(run.label)
        if not future.done():
            return
        try:
            found = future.result()
        except BrokenProcessPool:
            found = "stopped: a process of the study was killed; is there memory enough?"
        if not isinstance(found, str):
            from rodsim.scene.build import build_scene

            found = replace(found, scene=build_scene(run.case))
        run.found = found

    def _is_done_elsewhere(self, run):
        future = self._futures.get(id(run))
        return future is not None and future.done() and not future.cancelled()

    def _by_length(self):
        return sorted(self._asked.values(), key=lambda run: -run.weight)

    def _start(self, first):
        """Start a process for each core but this one's; give them all but ``first``."""
        self._others = {*active_children()}
        context = get_context("spawn")  # a forked one could not use the threads that are there
        self._pool = ProcessPoolExecutor(self.side_by_side - 1, context, initializer=_begin)
        for run in self._by_length():
            if run is not first:
                words = run.case, self.threads or 1, run.repeats, run.twin
                self._futures[id(run)] = self._pool.submit(_attempt_elsewhere, *words)


def _begin():
    """Prepare a process of a study: Ctrl-C is for the study, and without it there is no work."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_the_study, daemon=True).start()
    prepare()


def _end_with_the_study():
    parent_process().join()
    os._exit(1)


def _key(case):
    return json.dumps(case.resolved(), sort_keys=True)
