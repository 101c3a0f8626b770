"""Every error a user can meet. Only ``cli.py`` turns them into text and exit codes."""

from __future__ import annotations

from dataclasses import dataclass


class RodsimError(Exception):
    """Base of all errors that are not bugs; ``exit_code`` is what the command ends with."""

    exit_code = 1


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a case file.

    ``where`` is ``file:line`` or ``--set``, ``key`` the dotted path, ``value`` its text or ``None``
    when there is nothing to show, ``unit`` the unit the value is read in, or ``""``.
    """

    where: str
    key: str
    value: str | None
    reason: str
    unit: str = ""

    def __str__(self) -> str:
        subject = self.key if self.value is None else f"{self.key} = {self.value}{self.in_unit}"
        return ": ".join(part for part in (self.where, subject, self.reason) if part)

    @property
    def in_unit(self) -> str:
        """The unit as it stands behind a value."""
        return f" ({self.unit})" if self.unit else ""


class CaseError(RodsimError):
    """A case file or option is invalid; carries every problem found, one line each."""

    exit_code = 2

    def __init__(self, problems: list[Problem]):
        self.problems = list(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))


class UsageError(RodsimError):
    """A command or function was called in a way that cannot work."""

    exit_code = 2


class UnknownName(UsageError, KeyError):
    """A rod or array of a run that there is not, asked for by name."""

    __str__ = Exception.__str__  # not KeyError's, which quotes


class DivergedError(RodsimError):
    """The run stopped making sense; the message says where and what to do."""

    exit_code = 3


class StoppedError(RodsimError):
    """The run was asked to stop; the message says by what and how to go on."""

    exit_code = 75


class FileError(RodsimError):
    """An output, frame or shape file is missing, unreadable, locked, not ours, or not writable."""

    exit_code = 4


class StepFailure(RodsimError):
    """No step can be made from ``state``; the watch of the run turns it into a DivergedError."""

    def __init__(self, reason: str, state):
        super().__init__(reason)
        self.state = state


class SweepError(RodsimError):
    """Not every run of a sweep has finished. ``counts`` : how many have each status."""

    def __init__(self, counts):
        kinds = {"failed": FileError, "diverged": DivergedError}
        worst = [kind for status, kind in kinds.items() if counts[status]] or [StoppedError]
        self.exit_code = worst[0].exit_code
        order = ("finished", *kinds, "stopped", "running", "waiting")
        text = ", ".join(f"{counts[status]} {status}" for status in order if counts[status])
        left = counts["stopped"] + counts["running"] + counts["waiting"]
        on = "; the same command goes on" if left else ""
        super().__init__(text + on)
