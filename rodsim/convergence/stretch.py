"""Rows of a fixed step that would take longer than all others: run over the first part only.

Their evaluations are known beforehand, and every step takes the same time. Euler at its longest
stable step, the guide, is run to the end: it sees that this stays stable, and how an error made on
the way has grown by then. Two methods of one order err alike, so of half the guide's step

    e(T) = e(t) E(T)/E(t)

with the errors e of a row, E of the guide, at the ends of the stretch t and of the run T; of
another order it tells the size.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from rodsim.case.methods import FIXED_STEP
from rodsim.convergence.outcome import Errors, Outcome
from rodsim.convergence.rows import PARTS, Row

WHOLE = 2.0  # times the evaluations of the reference: what costs no more is run to the end


@dataclass(frozen=True)
class Stretch:
    """The rows that stretches are held against: reference and guide, and the first part of both."""

    reference: Row
    guide: Row
    guide_part: Row


def shorten(row: Row, case) -> Row:
    """Return a row that is run over the first part of the case only."""
    end = case.time.end / PARTS
    keys = (*row.overrides, f"time.end={end!r}", f"output.interval={end!r}")
    return replace(row, overrides=keys, part=1.0 / PARTS, evaluations=row.evaluations / PARTS)


def shorten_costly(found: list[Row], reference: Row, case) -> tuple[list[Row], Stretch | None]:
    """Return the rows, those that cost too much shortened, and what these are held against.

    The first is the guide. All must have a step that leads to the end of the stretch.
    """
    guide, *others = found
    made = [shorten(row, case) if _costly(row, reference) else row for row in others]
    if made == others or any(round(case.time.end / row.value) % PARTS for row in found):
        return found, None
    return [guide, *made], Stretch(shorten(reference, case), guide, shorten(guide, case))


def _costly(row, reference):
    return row.evaluations > WHOLE * reference.evaluations


def to_the_end(run: Outcome, row: Row, guide: Outcome) -> Outcome:
    """Return what a stretch of a row would have cost to the end.

    The guide tells what is counted beside the steps: estimates of the fastest rate.
    """
    steps = round(run.steps / row.part)
    beside = guide.evaluations - guide.steps
    count = beside + steps * FIXED_STEP[row.method].stages
    return replace(
        run,
        steps=steps,
        evaluations=count,
        seconds=tuple(seconds * count / run.evaluations for seconds in run.seconds),
    )


def grown(errors: Errors, guide_part: Errors, guide: Errors) -> Errors:
    """Return the errors of a stretch as they will be at the end: e(t) E(T)/E(t)."""
    three = (vars(e).values() for e in (errors, guide_part, guide))
    return Errors(*(_grown(*values) for values in zip(*three, strict=True)))


def _grown(error, then, at_end):
    return error * at_end / then if then else error  # None, where there is none of it
