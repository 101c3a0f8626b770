"""The runs of a sweep on their way through an engine: begun, gone on with, stopped."""

from __future__ import annotations

import uuid
from concurrent.futures import CancelledError
from itertools import takewhile

from rodsim.errors import DivergedError, StoppedError

ATTEMPTS = 5  # how often a run that was stopped by someone else is resumed
POLL_SECONDS = 0.2  # between two looks at what has ended and what is asked


class Sweep:
    """Runs on their way through an engine. ``ended(run, failure)`` is called for each.

    ``engine`` : a :class:`rodsim.sweep.local.Local` or :class:`rodsim.sweep.cluster.Cluster`.
    ``failure`` is the text of what went wrong, or None where the output says how the run ended.
    ``left(run)`` is called for those whose end was not seen. ``asked()`` tells whether to stop; it
    is looked at, since an exception in the middle of one of Dask's calls leaves it in disorder.
    """

    def __init__(self, engine, ended, left, asked):
        self.engine, self.ended, self.left, self.asked = engine, ended, left, asked
        self.token = uuid.uuid4().hex
        self.pending, self.attempts, self.stopping = {}, {}, False

    def finish(self, runs, display) -> None:
        """Do all runs. If asked to, stop them, ready to be resumed: KeyboardInterrupt.

        Raises StoppedError where the scheduler is lost.
        """
        try:
            for run in takewhile(lambda _: not self.asked(), runs):
                self._submit(run)
            self._wait(display)
        except CancelledError:  # nobody does that but Dask, and only when it has no scheduler
            gone = "the scheduler is gone; on another one the same command goes on"
            raise StoppedError(gone) from None
        finally:  # also of those whose end we did not see
            for run in self.pending.values():
                self.left(run)
        self.engine.dismiss(self.token)
        if self.stopping:
            raise KeyboardInterrupt

    def _submit(self, run):
        attempt = self.attempts[run.name] = self.attempts.get(run.name, 0) + 1
        self.pending[self.engine.submit(self.token, run, attempt)] = run

    def _wait(self, display):
        while self.pending:
            if self.asked():  # again and again: a worker may have been started since
                if not self.stopping:
                    display.say(
                        "stopping the runs, they can be resumed; Ctrl-C again leaves at once"
                    )
                self.stopping = True
                self._stop()
            for future in self.engine.ended(self.pending, POLL_SECONDS):
                self._end(self.pending.pop(future), future)
            display.look()

    def _stop(self):
        """Stop what the workers are at and take back the rest: none of it is begun any more."""
        begun = self.engine.stop(self.token)
        if begun is None:  # nobody could be asked: who waits will see
            return
        waiting = [f for f, run in self.pending.items() if run.name not in begun]
        self.engine.cancel(waiting)
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
