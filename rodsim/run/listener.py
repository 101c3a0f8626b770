"""Who hears of a run: one object, asked and told as it goes on. The default is silent."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field

from rodsim.progress import make_progress


@dataclass
class Summary:
    """How a run ended and what it cost.

    moved : where the output that had its name has gone, or None. runtime : the file's ``/runtime``.
    endings : in words, how small the gap got and how fast the rods still moved.
    """

    status: str = "running"
    frames: int = 0
    moved: str | None = None
    runtime: dict = field(default_factory=dict)
    endings: list[str] = field(default_factory=list)


class Listener:
    """Hears of a run and shows nothing but warnings. Override what you want to hear."""

    def compile(self, scene) -> float:
        """Compile what the scene needs, ahead of the run; return the seconds that it took.

        What is not compiled by then, the run itself compiles.
        """
        return 0.0

    def warn(self, text: str) -> None:
        """Hear what looks wrong but does not stop the run."""
        warnings.warn(text, stacklevel=2)

    def limits(self, limits) -> None:
        """Hear the ``integrators.limits.Limits`` of the scene before the first step."""

    def update(self, fraction: float, note: str) -> None:
        """Hear after each step which fraction of the run is done."""

    def stop(self) -> str:
        """Return, after each step, why the run is to stop there, or an empty text."""
        return ""

    def ended(self, summary: Summary) -> None:
        """Hear how the run has ended, however it has: also before an error goes up."""


class Functions(Listener):
    """A listener made of functions: ``notify`` hears warnings, ``stop`` is asked after each step,
    ``progress`` has ``update(fraction, note)``, or is True for the display that suits the place.
    None of them is as in a :class:`Listener`."""

    def __init__(self, notify=None, stop=None, progress=None, label=""):
        self._shown = make_progress(label, quiet=False) if progress is True else None
        self._begun = False
        if notify is not None:
            self.warn = notify
        if stop is not None:
            self.stop = stop
        if not (progress is None or isinstance(progress, bool)):
            self.update = progress.update

    def update(self, fraction, note):
        """Show the progress, where that is wanted, from the first step on."""
        if self._shown and not self._begun:
            self._shown.__enter__()
            self._begun = True
        if self._shown:
            self._shown.update(fraction, note)

    def ended(self, summary):
        """End the display of the progress."""
        if self._begun:
            self._shown.__exit__(None, None, None)
