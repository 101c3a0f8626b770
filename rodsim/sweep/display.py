"""What a sweep shows on stderr while it runs: a live table on a terminal, plain lines otherwise."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from time import monotonic

import click

from rodsim.errors import FileError
from rodsim.output import open_trajectory
from rodsim.output.paths import writing_process
from rodsim.sweep.summary import Summary

REFRESH_SECONDS = 1.0
STYLES = {"finished": "green", "diverged": "red", "failed": "red", "running": "yellow"}


class Lines:
    """A line for each run that has ended."""

    def __init__(self, summary: Summary, quiet: bool):
        self.summary, self.quiet = summary, quiet
        self.total = len(summary.rows)

    def __enter__(self):
        return self

    def __exit__(self, *error):
        return None

    def ended(self, row) -> None:
        """Show how a run has ended."""
        if self.quiet:
            return
        done = sum(r["status"] in ("finished", "diverged") for r in self.summary.rows.values())
        parts = [f"[{done}/{self.total}] {row['run']}: {row['status']}"]
        if "wall_seconds" in row:
            parts.append(f"{row['wall_seconds']:.1f} s")
        if "message" in row:
            parts.append(row["message"])
        click.echo(", ".join(parts), err=True)

    def say(self, text) -> None:
        """Tell the user something."""
        if not self.quiet:
            click.echo(text, err=True)

    def look(self) -> None:
        """Be called now and then."""


class Table(Lines):
    """The table of all runs and a bar over them, by Rich, redrawn in place."""

    def __init__(self, summary):
        from rich.console import Console
        from rich.live import Live
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TimeRemainingColumn

        super().__init__(summary, quiet=True)
        self.next = monotonic()
        self.console = Console(stderr=True)
        columns = (BarColumn(60), TaskProgressColumn(), TimeRemainingColumn())
        self.bar = Progress("all", *columns, console=self.console, auto_refresh=False)
        self.all = self.bar.add_task("all", total=self.total, completed=self._done(self._shares()))
        self.live = Live(console=self.console, auto_refresh=False)

    def __enter__(self):
        self.live.__enter__()
        return self

    def __exit__(self, *error):
        self._redraw()
        self.live.__exit__(*error)

    def say(self, text):
        """Print a line above the table."""
        self.console.print(text)

    def look(self):
        """Redraw, once a second."""
        if monotonic() >= self.next:
            self.next = monotonic() + REFRESH_SECONDS
            self._redraw()

    def _redraw(self):
        from rich.console import Group
        from rich.progress_bar import ProgressBar
        from rich.table import Table
        from rich.text import Text

        table = Table(box=None, pad_edge=False)
        for head in ("run", "status", "done", "wall time"):
            table.add_column(head, overflow="ellipsis", no_wrap=True)
        shares = self._shares()
        shown = self._shown(shares)
        for name in shown:
            share, status = shares[name]
            seconds = self.summary.rows[name].get("wall_seconds")
            wall = "" if seconds is None else f"{seconds:.1f} s"
            bar = ProgressBar(total=1.0, completed=share, width=20)
            table.add_row(name, Text(status, style=STYLES.get(status, "")), bar, wall)
        rest = len(shares) - len(shown)
        lines = [table, Text(f"and {rest} more")] if rest else [table]
        self.bar.update(self.all, completed=self._done(shares))
        self.live.update(Group(*lines, self.bar), refresh=True)

    def _shares(self):
        return {run.name: self._share(run) for run in self.summary.plan.runs}

    def _done(self, shares):
        return sum(share for share, _ in shares.values())

    def _share(self, run):
        """Return (part done, status) of a run; that of one on its way is read from its output."""
        row = self.summary.rows[run.name]
        if row["status"] in ("finished", "diverged", "failed"):
            return 1.0, row["status"]
        end = run.data["time"]["end"]
        if not writing_process(run.output):
            return row.get("time", 0.0) / end, row["status"]
        try:
            with open_trajectory(run.output) as output:
                return float(output.time[-1] / end) if output.frames else 0.0, "running"
        except FileError:
            return 0.0, "running"

    def _shown(self, shares):
        """Return the runs that fit on the terminal: those on their way, then the others."""
        room = max(3, self.console.height - 5)
        first = [name for name, (_, status) in shares.items() if status == "running"]
        rest = [name for name in shares if name not in first]
        chosen = set((first + rest)[:room])
        return [name for name in shares if name in chosen]


def make_display(summary: Summary, quiet: bool) -> Lines:
    """Return the display that suits stderr; the live one is Rich's, of the extra ``sweep``."""
    live = sys.stderr.isatty() and not quiet and find_spec("rich") is not None
    return Table(summary) if live else Lines(summary, quiet)
