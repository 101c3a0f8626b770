"""How far a run of a sweep has come: read from its output file, by whoever has written it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from rodsim.errors import FileError
from rodsim.output import Trajectory, open_trajectory
from rodsim.output.paths import writing_process
from rodsim.scene.inputs import CHANGED, compare_inputs, stored_digests
from rodsim.sweep.plan import Run

DONE = ("finished", "diverged")


def standing(run: Run) -> str:
    """Return ``finished``, ``diverged``, ``running`` (by some process), ``stopped`` or ``waiting``.

    An output counts only if its resolved case is that of the run, and the files this names are
    what they were. What is stopped can be resumed.
    """
    with opened(run) as (status, _):
        return status


@contextmanager
def opened(run: Run) -> Iterator[tuple[str, Trajectory | None]]:
    """Yield the standing of a run and its output, open; None where there is none that counts."""
    try:
        output = open_trajectory(run.output)
    except FileError:
        yield "waiting", None
        return
    with output:
        try:
            status = _status(run, output)
        except (FileError, ValueError):
            status = "waiting"
        yield status, output


def _status(run, output):
    if not _same_case(run, output) or _changed(run, output):
        return "waiting"
    if output.status in DONE:
        return output.status
    if writing_process(run.output):
        return "running"
    return "waiting" if output.checkpoint() is None else "stopped"


def changed_inputs(run: Run) -> list[str]:
    """Return the files for which alone an output of the run does not count any more."""
    try:
        with open_trajectory(run.output) as output:
            return _changed(run, output) if _same_case(run, output) else []
    except (FileError, ValueError):
        return []


def _same_case(run, output):
    return output.case_data() == run.data


def _changed(run, output):
    found = compare_inputs(stored_digests(output.inputs), run.inputs)
    return list(dict.fromkeys(file for file, state in found.values() if state == CHANGED))
