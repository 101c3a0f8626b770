"""Progress: a bar with time left on a terminal, a line in a notebook, plain lines otherwise."""

import sys
from time import monotonic

import click

from rodsim.text import printable

SECONDS_BETWEEN_LINES = 5.0
SECONDS_BETWEEN_CHANGES = 0.5
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


class Notebook(Silent):
    """A line in the output of a notebook's cell, changed in place."""

    def __init__(self, label):
        self._label, self._handle, self._next = label, None, 0.0

    def update(self, fraction, note=""):
        """Change the line, twice a second; the last one stays."""
        from IPython.display import display

        if monotonic() < self._next and fraction < 1.0:
            return
        self._next = monotonic() + SECONDS_BETWEEN_CHANGES
        shown = {"text/plain": f"{self._label}: {fraction:6.1%} {note}"}
        if self._handle is None:
            self._handle = display(shown, raw=True, display_id=True)
        else:
            self._handle.update(shown, raw=True)


def in_notebook() -> bool:
    """Tell whether this process is the kernel of a notebook."""
    found = sys.modules.get("IPython")
    return bool(found) and getattr(found.get_ipython(), "kernel", None) is not None


def make_progress(label: str, quiet: bool):
    """Return the progress display that suits stderr."""
    if quiet:
        return Silent()
    label = printable(label)
    if in_notebook():
        return Notebook(label)
    return Bar(label) if sys.stderr.isatty() else Lines(label)
