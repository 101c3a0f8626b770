"""The engine of a sweep on this machine: a thread for each of its workers, and nothing else."""

from __future__ import annotations

import queue
import threading
from concurrent.futures import Future
from contextlib import suppress

from rodsim.processes import usable_cores
from rodsim.sweep import work, workers


def share(runs: int, jobs: int | None, threads: int | None) -> tuple[int, int]:
    """Return (runs at once, threads of each) that fill this machine.

    Many runs on one thread each are faster than a few on many, so threads are only raised where
    there are fewer runs than cores.
    """
    cores = usable_cores()
    jobs = jobs or max(1, min(runs, cores // (threads or 1)))
    return jobs, threads or max(1, cores // jobs)


class Local:
    """Threads that each do one run at a time, by a worker each. A context manager."""

    def __init__(self, jobs: int, threads: int | None, alone: bool):
        """``jobs`` runs at once, ``threads`` of each; ``alone``: a process for each run."""
        self.jobs, self.threads, self.alone = jobs, threads, alone
        self._orders: queue.SimpleQueue = queue.SimpleQueue()
        self._ended: queue.SimpleQueue = queue.SimpleQueue()

    def __enter__(self):
        # Daemons, which nobody waits for: a second Ctrl-C leaves at once, in the middle of runs.
        for _ in range(self.jobs):
            threading.Thread(target=self._serve, daemon=True).start()
        return self

    def __exit__(self, *error):
        for _ in range(self.jobs):
            self._orders.put(None)

    def submit(self, sweep: str, run, attempt: int) -> Future:
        """Let a run be done when a thread is free; the future has what ``work`` returns."""
        future: Future = Future()
        future.add_done_callback(self._ended.put)
        self._orders.put((future, (sweep, run, self.threads, self.alone)))
        return future

    def ended(self, pending, seconds: float) -> list[Future]:
        """Return those of the pending futures that have ended; wait for the first one so long."""
        found = []
        with suppress(queue.Empty):
            found.append(self._ended.get(timeout=seconds))
            while True:
                found.append(self._ended.get_nowait())
        return [future for future in found if future in pending]

    def stop(self, sweep: str) -> list[str]:
        """Stop the runs of a sweep, return those that are begun, see :func:`work.stop`."""
        return work.stop(sweep)

    def cancel(self, futures) -> None:
        """Take runs back that have not begun."""
        for future in futures:
            future.cancel()

    def dismiss(self, sweep: str) -> None:
        """Let the workers go that did the runs of a sweep."""
        workers.dismiss(sweep)

    def _serve(self):
        for future, order in iter(self._orders.get, None):
            if not future.set_running_or_notify_cancel():
                continue
            try:
                future.set_result(work.work(*order))
            except Exception as error:  # is told with its run
                future.set_exception(error)
