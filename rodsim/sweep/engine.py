"""Dask distributed as the engine of a sweep: here, or on the cluster of a scheduler."""

from __future__ import annotations

import itertools
import logging
import signal
import uuid
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from time import sleep

from rodsim.errors import DivergedError, StoppedError, UsageError
from rodsim.sweep.work import stop, work

try:
    import distributed
    from dask.system import CPU_COUNT
except ImportError as error:
    raise UsageError("sweep needs Dask: pip install 'rodsim[sweep]'") from error

ATTEMPTS = 5  # how often a run that was stopped by someone else is resumed
POLL_SECONDS = 0.2
CONNECT_SECONDS = 15


def share(runs: int, jobs: int | None, threads: int | None) -> tuple[int, int]:
    """Return (runs at once, threads of each) that fill this machine.

    Many runs on one thread each are faster than a few on many, so threads are only raised where
    there are fewer runs than cores.
    """
    jobs = jobs or max(1, min(runs, CPU_COUNT // (threads or 1)))
    return jobs, threads or max(1, CPU_COUNT // jobs)


class _Undisturbed(distributed.WorkerPlugin):
    """Ctrl-C on the terminal is for the sweep itself, not for its workers.

    A handler and not SIG_IGN: that one the runs would inherit.
    """

    def setup(self, worker):
        signal.signal(signal.SIGINT, lambda *_: None)


@contextmanager
def local_cluster(jobs: int, threads: int):
    """Start workers on this machine, one run at a time each; yield their client."""
    with (
        distributed.LocalCluster(
            n_workers=jobs,
            threads_per_worker=1,
            processes=True,
            memory_limit=0,
            dashboard_address=":0",
            scheduler_kwargs={"dashboard": False},
            silence_logs=logging.CRITICAL,
            env={"NUMBA_NUM_THREADS": str(threads)},
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        client.register_plugin(_Undisturbed())
        yield client


@contextmanager
def remote_cluster(address: str):
    """Connect to a scheduler that is there already; yield the client."""
    logging.disable()  # what goes wrong is said here, in a line
    try:
        client = distributed.Client(address, timeout=CONNECT_SECONDS)
    except (OSError, TimeoutError, ValueError) as error:
        raise UsageError(f"--scheduler {address}: cannot be reached: {error}") from error
    try:
        with client:
            yield client
    finally:
        logging.disable(logging.NOTSET)


class Sweep:
    """Runs on their way through a cluster. ``ended(run, failure)`` is called for each.

    ``failure`` is the text of what went wrong, or None where the output says how the run ended.
    ``left(run)`` is called for those whose end was not seen. ``asked()`` tells whether to stop; it
    is looked at, since an exception in the middle of one of Dask's calls leaves it in disorder.
    """

    def __init__(self, client, threads, ended, left, asked):
        self.client, self.threads, self.ended, self.left = client, threads, ended, left
        self.asked = asked
        self.token = uuid.uuid4().hex
        self.pending, self.attempts, self.stopping = {}, {}, False

    def finish(self, runs, display) -> None:
        """Do all runs. If asked to, stop them, ready to be resumed: KeyboardInterrupt.

        Raises StoppedError where the scheduler is lost.
        """
        try:
            for run in itertools.takewhile(lambda _: not self.asked(), runs):
                self._submit(run)
            self._wait(display)
        except CancelledError:  # nobody does that but Dask, and only when it has no scheduler
            gone = "the scheduler is gone; on another one the same command goes on"
            raise StoppedError(gone) from None
        finally:  # also of those whose end we did not see
            for run in self.pending.values():
                self.left(run)
        if self.stopping:
            raise KeyboardInterrupt

    def _submit(self, run):
        attempt = self.attempts[run.name] = self.attempts.get(run.name, 0) + 1
        key = f"{run.name} {self.token} {attempt}"
        future = self.client.submit(work, self.token, run, self.threads, key=key, pure=False)
        self.pending[future] = run

    def _wait(self, display):
        while self.pending:
            if any(future.cancelled() for future in self.pending):
                raise CancelledError
            if self.asked():  # again and again: a worker may have been started since
                if not self.stopping:
                    display.say(
                        "stopping the runs, they can be resumed; Ctrl-C again leaves at once"
                    )
                self.stopping = True
                self._stop()
            for future in [future for future in self.pending if future.done()]:
                self._end(self.pending.pop(future), future)
            display.look()
            sleep(POLL_SECONDS)

    def _stop(self):
        """Stop what the workers are at and take back the rest: none of it is begun any more."""
        begun = []
        with suppress(OSError):  # the scheduler is gone: seen by who waits
            for names in self.client.run(stop, self.token, on_error="ignore").values():
                begun += names
            waiting = [f for f, run in self.pending.items() if run.name not in begun]
            self.client.cancel(waiting)
            for future in waiting:
                self.left(self.pending.pop(future))

    def _end(self, run, future):
        """Resume a run that someone else has stopped or killed, such as a queue out of time."""
        problem = future.exception()
        if problem is not None:
            return self.ended(run, f"{type(problem).__name__}: {problem}".split("\n")[0])
        code, said = future.result()
        cut_short = code == StoppedError.exit_code or code < 0  # negative: by a signal
        if cut_short and not self.stopping and self.attempts[run.name] < ATTEMPTS:
            return self._submit(run)
        if code in (0, DivergedError.exit_code) or cut_short:
            return self.ended(run, None)
        return self.ended(run, said or f"its command ended with code {code}")
