"""Stopping early on purpose: a signal or the end of the wall time, heard between two steps."""

from __future__ import annotations

import re
import signal
import threading
from time import monotonic

# What Ctrl-C, kill and batch systems send, and a terminal that is closed; not all are everywhere.
SIGNALS = ("SIGINT", "SIGTERM", "SIGUSR1", "SIGHUP")
_DURATION = re.compile(
    r"\s*(?:(?P<d>\d+(?:\.\d*)?)d)?\s*(?:(?P<h>\d+(?:\.\d*)?)h)?"
    r"\s*(?:(?P<m>\d+(?:\.\d*)?)m(?:in)?)?\s*(?:(?P<s>\d+(?:\.\d*)?)s?)?\s*"
)
_SECONDS = {"d": 86400.0, "h": 3600.0, "m": 60.0, "s": 1.0}
_for_all: list[str] = []  # why every run of this process stops


def parse_duration(text: str) -> float:
    """Return seconds of ``3h50m``, ``90s``, ``1.5h``, ``2d``, ``90``; ValueError if it is none."""
    found = _DURATION.fullmatch(text)
    given = {unit: float(n) for unit, n in found.groupdict().items() if n} if found else {}
    seconds = sum(number * _SECONDS[unit] for unit, number in given.items())
    if not seconds > 0.0:
        raise ValueError(f"{text!r} is not a duration such as 3h50m, 90s or 1.5h")
    return seconds


def signals() -> list[int]:
    """Return the signals to stop for; nohup has SIGHUP ignored, and so it stays."""
    found = [getattr(signal, name) for name in SIGNALS if hasattr(signal, name)]
    hangup = getattr(signal, "SIGHUP", None)
    return [n for n in found if n != hangup or signal.getsignal(n) != signal.SIG_IGN]


def stop_all(reason: str) -> None:
    """Let every run of this process stop after its step, also those that have not begun."""
    _for_all.append(reason)


class Stopper:
    """Says, between two steps, why the run is to stop. A context manager that hears signals.

    With ``max_wall`` seconds it also stops before a step as long as the longest one so far would
    end too late. A second Ctrl-C does not wait for the step: KeyboardInterrupt.
    """

    def __init__(self, max_wall: float | None = None):
        self.deadline = None if max_wall is None else monotonic() + max_wall
        self.reason, self._before = "", {}
        self._longest, self._last = 0.0, None

    def __enter__(self):
        if threading.current_thread() is threading.main_thread():
            for number in signals():
                self._before[number] = signal.signal(number, self._hear)
        return self

    def __exit__(self, *error):
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def __call__(self) -> str:
        """Return the reason to stop now, empty if there is none. Call once after each step."""
        now = monotonic()
        if self._last is not None:  # before the first step lies the start: kernels, the file
            self._longest = max(self._longest, now - self._last)
        self._last = now
        if not self.reason and _for_all:
            self.reason = _for_all[0]
        if not self.reason and self.deadline is not None and now + self._longest > self.deadline:
            self.reason = "the wall time given by --max-wall"
        return self.reason

    def _hear(self, number, frame):
        if self.reason and number == signal.SIGINT:
            raise KeyboardInterrupt
        self.reason = signal.Signals(number).name
