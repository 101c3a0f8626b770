"""Does a file hold what it says? Every committed frame is read, and the checkpoint."""

from __future__ import annotations

from functools import partial

import numpy as np

from rodsim.output.layout import FIELDS, OF_BODIES
from rodsim.output.reader import Trajectory

BLOCK = 2**24  # bytes read at a time
ORTHONORMAL = 1e-6  # of a triad; a run keeps them to rounding


def whole_frames(run: Trajectory) -> int:
    """Return how many frames, from the first, are whole, as ``verify`` means it."""
    return min((first for first, _ in _damage(run)), default=run.frames)


def verify(run: Trajectory) -> list[str]:
    """Return what is wrong with the frames of an open file; raises FileError where it is torn.

    Every number of every committed frame is finite, times are those planned, steps do not
    decrease, triads are orthonormal, and a checkpoint is whole.
    """
    run.case_data()
    found = [what for _, what in _damage(run)]
    if run.checkpoint() is None:
        found.append("neither of its checkpoints is whole: it cannot be resumed")
    return found


def _damage(run):
    """Yield (first frame, what) for everything that cannot be right."""
    for bad, what in (
        (run.time != run.planned[: run.frames], "the times of its frames are not those planned"),
        (np.diff(run.steps, prepend=0) < 0, "the numbers of its steps decrease"),
    ):
        if bad.any():
            yield int(bad.argmax()), what
    for name, read, size in _series(run):
        yield from _bad_frames(run, name, read, size)


def _series(run):
    sizes = dict.fromkeys(FIELDS, 24 * run.points) | {"director": 72 * run.points}
    for name in run.fields:
        size = sizes.get(name) or 8 * run.read(name, slice(0, 1)).size
        yield name, partial(run.read, name), size
    for name in run.observables:
        yield name, partial(run.observable, name), 24 * len(run.rods)
    for name in OF_BODIES if run.bodies else ():
        yield f"{name} of bodies", partial(run.of_bodies, name), 32 * len(run.bodies)
    yield "rotors", run.of_rotors, 56


def _bad_frames(run, name, read, size):
    """Yield (frame, what) of the first frame of a series that cannot be right."""
    rows = max(1, BLOCK // max(1, size))
    for first in range(0, run.frames, rows):
        values = read(slice(first, min(first + rows, run.frames)))
        good = np.isfinite(values).reshape(len(values), -1).all(axis=1)
        if name == "director":
            with np.errstate(all="ignore"):
                product = values @ values.swapaxes(-1, -2) - np.eye(3)
                worst = abs(product).reshape(len(values), -1).max(axis=1, initial=0.0)
            good &= worst < ORTHONORMAL
        if not good.all():
            bad = first + int(good.argmin())
            yield bad, f"{name} in frame {bad} is damaged"
            return
