"""The engine of a sweep on the workers of a Dask scheduler, on other machines as a rule."""

from __future__ import annotations

import logging
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from time import sleep

from rodsim.errors import UsageError
from rodsim.sweep.work import stop, work
from rodsim.sweep.workers import dismiss

try:
    import distributed
except ImportError as error:
    raise UsageError("--scheduler needs Dask: pip install 'rodsim[sweep]'") from error

CONNECT_SECONDS = 15


class Cluster:
    """Dask workers, each thread of which does one run at a time, by a process of its own.

    The same calls as :class:`rodsim.sweep.local.Local` has.
    """

    def __init__(self, client, threads: int | None, alone: bool):
        self.client, self.threads, self.alone = client, threads, alone

    def submit(self, sweep: str, run, attempt: int):
        """Let a run be done when a worker is free; the future has what ``work`` returns."""
        key = f"{run.name} {sweep} {attempt}"
        words = (sweep, run, self.threads, self.alone)
        return self.client.submit(work, *words, key=key, pure=False)

    def ended(self, pending, seconds: float) -> list:
        """Return those of the pending futures that have ended; if none, after so long.

        Raises CancelledError where the scheduler is lost.
        """
        if any(future.cancelled() for future in pending):
            raise CancelledError
        found = [future for future in pending if future.done()]
        if not found:
            sleep(seconds)
        return found

    def stop(self, sweep: str) -> list[str] | None:
        """Stop the runs of a sweep on all workers; return the names of those that are begun.

        None where the scheduler is lost.
        """
        found = self._everywhere(stop, sweep)
        return None if found is None else [name for names in found.values() for name in names]

    def cancel(self, futures) -> None:
        """Take runs back that have not begun."""
        with suppress(OSError):
            self.client.cancel(futures)

    def dismiss(self, sweep: str) -> None:
        """Let the processes go that did the runs of a sweep."""
        self._everywhere(dismiss, sweep)

    def _everywhere(self, function, sweep):
        with suppress(OSError):  # the scheduler is gone: seen by who waits
            return self.client.run(function, sweep, on_error="ignore")
        return None


@contextmanager
def connect(address: str, threads: int | None, alone: bool):
    """Connect to a scheduler that is there already; yield the engine."""
    logging.disable()  # what goes wrong is said here, in a line
    try:
        client = distributed.Client(address, timeout=CONNECT_SECONDS)
    except (OSError, TimeoutError, ValueError) as error:
        raise UsageError(f"--scheduler {address}: cannot be reached: {error}") from error
    try:
        with client:
            yield Cluster(client, threads, alone)
    finally:
        logging.disable(logging.NOTSET)
