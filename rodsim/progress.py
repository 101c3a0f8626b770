"""Progress on stderr: a bar with time left on a terminal, a plain line now and then otherwise."""

import sys
from time import monotonic

import click

from rodsim.text import printable

SECONDS_BETWEEN_LINES = 5.0
BAR_STEPS = 1000


class Silent:
    """Shows nothing; also what a library call uses."""

    def __enter__(self):
        return self

    def __exit__(self, *error):
        return None

    def update(self, fraction: float, note: str = "") -> None:
        """Report that ``fraction`` of the run is done."""


class Bar(Silent):
    """click's own progress bar, which estimates the time left."""

    def __init__(self, label):
        self._bar = click.progressbar(
            length=BAR_STEPS, label=label, file=sys.stderr, show_pos=False, show_eta=True
        )
        self._done = 0

    def __enter__(self):
        self._bar.__enter__()
        return self

    def __exit__(self, *error):
        self._bar.__exit__(*error)

    def update(self, fraction, note=""):
        """Move the bar to ``fraction``."""
        done = int(BAR_STEPS * fraction)
        if done > self._done:
            self._bar.update(done - self._done)
            self._done = done


class Lines(Silent):
    """A line every few seconds, for logs and job schedulers."""

    def __init__(self, label):
        self._label, self._start, self._first = label, None, 0.0

    def update(self, fraction, note=""):
        """Print a line if the last one is long enough ago."""
        now = monotonic()
        if self._start is None:
            self._start, self._next = now, now + SECONDS_BETWEEN_LINES
            self._first = fraction  # not 0 in a run that goes on
        if now < self._next or fraction <= self._first:
            return
        self._next = now + SECONDS_BETWEEN_LINES
        left = (now - self._start) * (1.0 - fraction) / (fraction - self._first)
        click.echo(f"{self._label}: {fraction:6.1%} {note}, {left:.0f} s left", err=True)


def make_progress(label: str, quiet: bool):
    """Return the progress display that suits stderr."""
    if quiet:
        return Silent()
    label = printable(label)
    return Bar(label) if sys.stderr.isatty() else Lines(label)
