"""A search for rest from start to file."""

from __future__ import annotations

from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from rodsim.rest.forces import Forces, stored_energies
from rodsim.rest.output import NUMBER, UNKNOWN, topology, write_states
from rodsim.rest.solve import Rest, find_rest, scales_of
from rodsim.rest.start import Start


@dataclass(frozen=True)
class Report:
    """What a search has come to.

    energies : of the start and of the rest, by name. topology : writhe and linking number (2, R) of
    both. moved : where an older output has gone, or None.
    """

    start: Start
    rest: Rest
    energies: tuple[dict, dict]
    topology: tuple[np.ndarray, np.ndarray]
    seconds: float
    moved: str | None = None


def find(start: Start, output, saddle=False, overwrite=False, steps=None, warn=None) -> Report:
    """Find the state at rest of a start, write it as an output; return the :class:`Report`.

    steps : shows progress, a ``rest.report.Steps``. Raises FileError.
    """
    begin, scene, settings = perf_counter(), start.scene, start.case.rest
    tolerance = scales_of(scene, settings).tolerance
    if steps is None:
        rest = find_rest(scene, settings, saddle)
    else:
        with steps:
            rest = find_rest(scene, settings, saddle, lambda r, n: steps(r, n, tolerance))
    states = scene.initial, rest.state
    seconds = perf_counter() - begin
    report = Report(
        start,
        rest,
        tuple(stored_energies(scene, state) for state in states),
        tuple(topology(scene, state) for state in states),
        seconds,
    )
    status, cost = "diverged" if rest.failure else "finished", _cost(report)
    how = _times(start), _series(report), status, cost, overwrite, warn
    moved = write_states(output, start, states, *how)
    return replace(report, moved=str(moved) if moved else None)


def _times(start):
    """Return the times of both frames: 0 and the end of the case, or from a time just on."""
    time, end = start.scene.initial.time, start.case.time.end
    return (time, np.nextafter(time, np.inf) + 1e-9 * end) if time else (0.0, end)


def _series(report):
    """Return what is stored of both states beyond the observables of a run."""
    scales = scales_of(report.start.scene, report.start.case.rest)
    before = scales.residual(
        Forces(report.start.scene, exact=False).loads(report.start.scene.initial)
    )
    rest = report.rest
    found = {"residual": (NUMBER, (before, rest.residual))}
    for name, count in (("growing_modes", rest.growing), ("neutral_modes", rest.neutral)):
        found[name] = NUMBER, (UNKNOWN, UNKNOWN if count is None else float(count))
    for row, name in enumerate(("writhe", "linking_number")):
        values = [both[row] for both in report.topology]
        if np.isfinite(values).all():
            found[name] = NUMBER, values
    return found


def _cost(report):
    rest = report.rest
    return {
        "wall_seconds": report.seconds,
        "solve_seconds": report.seconds,
        "steps_accepted": rest.steps,
        "steps_rejected": rest.rejected,
    }
