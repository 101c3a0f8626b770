"""Opens the file of a run that has ended to go on writing it, in place or in a longer copy."""

from __future__ import annotations

import numpy as np

from rodsim.compiled.settings import machine
from rodsim.errors import FileError
from rodsim.output import layout
from rodsim.output.guarded import GuardedFile
from rodsim.output.layout import CLOCK, Plan
from rodsim.output.reader import Trajectory
from rodsim.output.rows import open_to_write
from rodsim.output.vtkhdf import View
from rodsim.output.writer import TrajectoryWriter, short

BLOCK = 2**24  # bytes copied at a time


def reopen(path, plan: Plan, lock) -> TrajectoryWriter:
    """Open a file to go on in it; the lock is held. Raises FileError where it is not as planned."""
    _check_layout(path, plan)
    try:
        file = open_to_write(path, new=False)
    except OSError as error:
        raise FileError(f"{path}: cannot be written: {error}") from error
    writer = TrajectoryWriter(path, file, plan, lock)
    with writer.writing():
        View(file["VTKHDF"]).show_all(plan.times[: writer.committed])
        file.attrs.modify("status", short("running"))
        file.flush()
    writer.update_runtime(machine() | (plan.device or {"device": "cpu"}))
    return writer


def extend(path, plan: Plan, lock, run: Trajectory, compute) -> TrajectoryWriter:
    """Make a file with room for more, copy all frames of ``run`` into it, put it in its place.

    ``compute(index)`` returns the fields of an earlier frame; called only if ``run`` lacks some.
    """

    def fill(writer):
        _copy_frames(writer, plan, run, compute)
        for text in run.resumes:
            note_resume(writer, text)

    return TrajectoryWriter.create_locked(path, plan, lock, True, fill)


def note_resume(writer: TrajectoryWriter, text: str) -> None:
    """Add a line to the history of resumes; the last place is used again when all are taken."""
    with writer.writing() as file:
        history = file["case/resumes"]
        taken = int(np.count_nonzero(history[:]))
        index = min(taken, len(history) - 1)
        history[index] = np.bytes_(text.encode()[: layout.RESUME_BYTES])
        file.flush()


def _copy_frames(writer, plan, run, compute):
    missing = [s for s in plan.fields_stored() if s.name not in run.fields]
    with writer.writing() as file:
        for series in plan.stored():
            if series in missing:
                continue
            row_bytes = 8 * max(1, int(np.prod(series.shape)))
            rows = max(1, BLOCK // row_bytes)
            for first in range(0, run.frames, rows):
                block = slice(first, min(first + rows, run.frames))
                file[f"{series.where}/value"][block] = run.values(series, block)
        for index in range(run.frames if missing else 0):
            fields = compute(index)
            for series in missing:
                row = np.moveaxis(fields[series.name], -1, 0)
                file[f"{series.where}/value"][index] = row
        file[f"{CLOCK}/time"][: run.frames] = run.time
        file[f"{CLOCK}/step"][: run.frames] = run.steps
        file["committed"][()] = writer.committed = run.frames
        View(file["VTKHDF"]).show_all(run.time)


def _check_layout(path, plan):
    """Refuse what is not built as planned: nothing may be written anywhere but into this file."""
    with GuardedFile(path) as file:
        for series in plan.stored():
            file.contiguous(f"{series.where}/value", "f", (len(plan.times), *series.shape))
        file.contiguous(f"{CLOCK}/time", "f", (len(plan.times),))
        file.contiguous(f"{CLOCK}/step", "i", (len(plan.times),))
        file.contiguous("committed", "i", ())
        file.contiguous("case/resumes", "S", (layout.MOST_RESUMES,))
        for slot in file.names("checkpoint"):
            for name in file.names(f"checkpoint/{slot}"):
                file.contiguous(f"checkpoint/{slot}/{name}", "fiub", None)
        file.growing("VTKHDF/Steps/Values", "f")
        file.attribute("VTKHDF/Steps", "NSteps", int)
        stored = file.attributes("runtime")
        if not stored.keys() >= layout.RUNTIME.keys():
            raise file.damaged("runtime is not complete")
