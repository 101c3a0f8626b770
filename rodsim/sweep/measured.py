"""The quantities that a sweep's table has on top of its own results: ``--measure``."""

from __future__ import annotations

import math
from dataclasses import replace

from rodsim.analysis.measures import MEASURES
from rodsim.analysis.measuring import Picked, of_run, parse
from rodsim.analysis.subjects import KINDS
from rodsim.analysis.swimming import whole_periods
from rodsim.case.words import did_you_mean
from rodsim.errors import UsageError


class Measured:
    """Quantities by name, of the rods that the runs of a plan have. Raises UsageError.

    ``columns`` : the unit of each column, by its name.
    """

    def __init__(self, texts, plan):
        cases = [run.data for run in plan.runs]
        found = [picked for text in texts for picked in _picked(text, cases)]
        self._picked = list({picked.names[0]: picked for picked in found}.values())
        heads = [c for picked in self._picked for c in picked.columns(cases[0]["units"])]
        self.columns = {column.name: column.unit for column in heads}

    def of(self, output, period) -> dict[str, float]:
        """Return the numbers of a run; those that it does not have, or that are none, are left out.

        A run that has not come to the end of its second period has none of those over periods.
        """
        here = [picked for found in self._picked if (picked := _in_run(found, output))]
        if period and not _reaches(output, period):
            here = [picked for picked in here if not picked.measure.number]
            period = None
        numbers = of_run(output, here, period)
        return {name: value for name, value in numbers.items() if not math.isnan(value)}


def _picked(text, cases):
    """Return a quantity of every rod that any of the cases has, or of the one that is named."""
    of, measure = parse(text, MEASURES)
    names = dict.fromkeys(name for case in cases for name in KINDS[measure.per].of_case(case))
    if of and of not in names:
        near = did_you_mean(of, names) or f": there is {', '.join(filter(None, names))}"
        raise UsageError(f"--measure {text}: no {measure.per} '{of}'{near}")
    return [Picked(measure, name) for name in ([of] if of else names)]


def _in_run(picked, output):
    """Return a quantity with its subject in a run, None where the run lacks either."""
    subjects = KINDS[picked.measure.per].of_run(output)
    if picked.of not in subjects or picked.measure.lacks(output):
        return None
    subject = subjects[picked.of]
    return replace(picked, subject=subject) if picked.measure.fits(subject) else None


def _reaches(output, period):
    try:
        return whole_periods(output.time, period).any()
    except UsageError:
        return False
