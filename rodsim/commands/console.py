"""What a terminal shows of a run, and what stops it: the listener of ``run`` and ``resume``."""

from rodsim.commands import reports
from rodsim.commands.common import say, warn
from rodsim.progress import make_progress
from rodsim.run.listener import Listener
from rodsim.run.stopping import Stopper


class Console(Listener):
    """Shows progress and summary on stderr, hears signals. A context manager around the run."""

    def __init__(self, output, quiet: bool, max_wall: float | None):
        self.output, self.quiet = output, quiet
        self._stopper = Stopper(max_wall)
        self._progress, self._time_unit = None, ""

    def about(self, case, name: str) -> "Console":
        """Take title and units from the case that is run."""
        self._progress = make_progress(case.title or name, self.quiet)
        self._time_unit = case.units.time
        return self

    def __enter__(self):
        self._stopper.__enter__()
        self._progress.__enter__()
        return self

    def __exit__(self, *error):
        self._progress.__exit__(*error)
        self._stopper.__exit__(*error)

    def compile(self, scene):
        """Compile in a process of its own, and say so."""
        from rodsim.run.warmup import ensure_compiled

        return ensure_compiled(scene, self._say)

    def warn(self, text):
        """Show a warning."""
        warn(text)

    def limits(self, limits):
        """Show what is known of the step."""
        self._say("\n".join(reports.describe_limits(limits, self._time_unit)))

    def update(self, fraction, note):
        """Move the progress on."""
        self._progress.update(fraction, note)

    def stop(self):
        """Return what has been heard."""
        return self._stopper()

    def ended(self, summary):
        """Show how the run has ended and what it has cost."""
        self._say(reports.run_summary(summary, self.output))

    def _say(self, text):
        if not self.quiet:
            say(text)
