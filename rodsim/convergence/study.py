"""The rows of a study, each held against a reference when both have ended."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from rodsim.analysis.difference import position_errors
from rodsim.convergence import rows
from rodsim.convergence.outcome import Errors, Outcome, compare
from rodsim.convergence.plan import TIMED, plan
from rodsim.convergence.rows import Row
from rodsim.convergence.side_by_side import REFUSED, Runs
from rodsim.convergence.stretch import grown, to_the_end
from rodsim.errors import CaseError, FileError, UsageError
from rodsim.integrators.limits import stability
from rodsim.scene.build import build_scene
from rodsim.scene.inputs import SAME, case_digests, compare_inputs
from rodsim.scene.system import RodSystem

CLOCKED = (*TIMED, "accuracy")  # axes whose seconds are to be compared
REPEATS = 3
BESIDE = 50_000  # pairs that all but the sums takes as long as, in an evaluation
ROUNDING = 1e-12  # of the longest rod: what a last bit is after a stable run
AMPLIFIED = 0.3  # of the reference's own error: rounding is then part of it
DONE = ""


@dataclass(frozen=True)
class Result:
    """A row that was run, or ``status``: why not."""

    row: Row
    outcome: Outcome | None = None
    errors: Errors | None = None
    status: str = DONE


@dataclass
class Section:
    """One axis: its reference, in words and with its own error, and the rows so far.

    ``rounding``: how far the same steps end from each other from starts that differ in the last
    bit; ``length``: of the longest rod.
    """

    axis: str
    reference: str
    own: Errors | None = None
    rounding: float | None = None
    length: float = math.inf
    results: list[Result] = field(default_factory=list)

    @property
    def floor(self) -> float:
        """Position error below which nothing can be told: the reference's own, or rounding's."""
        return max(self.own.position if self.own else 0.0, self.rounding or 0.0)

    @property
    def amplified(self) -> bool:
        """Whether rounding alone moves the end so far that ``own`` is no bound."""
        if not (self.own and self.rounding) or self.rounding < ROUNDING * self.length:
            return False
        return self.rounding > AMPLIFIED * self.own.position


class Study:
    """Error against run time of a case.

    ``load(overrides)`` returns the case with more keys changed; ``axes`` are some of
    ``rows.AXES``; ``whole``: rows of a fixed step are run to their end, however long that takes.
    """

    def __init__(self, load: Callable, axes, threads=None, progress=None, whole=False):
        self.load, self.threads, self.case, self.whole = load, threads, load(()), whole
        self.scene, self._inputs = build_scene(self.case), case_digests(self.case)
        self.limits = stability(RodSystem(self.scene))
        self.axes = [axis for axis in rows.AXES if axis in axes]
        self.sections: list[Section] = []
        self._runs, self._cases = Runs(threads, progress), {}

    def run(self) -> Iterator[tuple[Section, Result]]:
        """Yield each row as it ends; ``sections`` holds them all.

        Raises UsageError where a reference cannot be had, or for an axis that the scene does not
        have.
        """
        parts = plan(self.case, self.scene, self.limits, self.axes, self.whole)
        for row in [row for part in parts for row in part.all_rows]:
            self._ask(row)
        for row in {part.twin for part in parts if part.twin}:
            self._ask(row, twin=True)
        with self._runs:
            for part in parts:
                yield from self._section(part)

    @property
    def side_by_side(self) -> int:
        """How many runs go on at once."""
        return self._runs.side_by_side

    def _ask(self, row, twin=False):
        """Ask for the run of a row; of one that cannot be, remember in words why not."""
        own = f"fluid.epsilon={self.scene.epsilon!r}"  # so that rows with the same case know it
        try:
            case = self.load((*rows.quiet(self.case), own, *row.overrides))
        except CaseError as error:
            self._cases[row] = f"{REFUSED}: {error.problems[0].reason}"
            return
        self._cases[row] = case
        repeats = REPEATS if row.axis in CLOCKED else 1
        label = f"{row.method} {row.axis} {row.value:g}"
        self._runs.ask(label, case, self._weight(row), twin, repeats)

    def _section(self, part):
        """Yield the rows of a part, each held against its reference."""
        first, *others = part.rows
        reference = self._outcome(first)
        if not isinstance(reference, Outcome):
            raise UsageError(f"{part.axis}: the reference ({part.words}) is {reference}")
        section = Section(part.axis, part.words, length=reference.scene.length_scale)
        self.sections.append(section)
        # How good it is: beside the next best run, and what rounding does.
        if part.check:
            found = self._outcome(part.check)
            if isinstance(found, Outcome):
                section.own = _own(part.axis, compare(found, reference))
        if part.twin:
            section.rounding = self._rounding(part.twin)
        if part.axis in ("points", "body_points", "accuracy"):
            others = [*others, first]
        for row in others:
            result = self._result(part, row, reference)
            section.results.append(result)
            yield section, result

    def _rounding(self, row):
        run = self._outcome(row)
        if not isinstance(run, Outcome):
            return None
        return position_errors(run.twin.position, run.end.position)[0]

    def _result(self, part, row, reference):
        found = self._outcome(row)
        if not isinstance(found, Outcome):
            return Result(row, status=found)
        if row is part.rows[0]:
            return Result(row, found)
        if row.part < 1.0:
            return self._stretch(part.stretch, row, found, reference)
        return Result(row, found, compare(found, reference))

    def _stretch(self, stretch, row, run, reference):
        """Return what a row that is run over a stretch comes to at the end."""
        held = (stretch.reference, stretch.guide, stretch.guide_part)
        exact, guide, guide_part = (self._outcome(other) for other in held)
        for found in (exact, guide, guide_part):
            if not isinstance(found, Outcome):
                return Result(row, status=f"run to {row.part:.0%}, euler is {found}")
        at_end, then = compare(guide, reference), compare(guide_part, exact)
        return Result(row, to_the_end(run, row, guide), grown(compare(run, exact), then, at_end))

    def _outcome(self, row):
        """Return the outcome of a row, or in words why there is none."""
        case = self._cases[row]
        if isinstance(case, str):
            return case
        found = self._runs.outcome(case)
        self._same_inputs(case)
        return found

    def _same_inputs(self, case):
        """Raise FileError where a file that the case names is not what it was at the start."""
        for file, state in compare_inputs(self._inputs, case_digests(case)).values():
            if state != SAME:
                raise FileError(f"{file}: {state}: the rows before are of another scene")

    def _weight(self, row):
        """Return the cost of a row in pairs of its sums, roughly."""
        points = row.value if row.axis == "points" else self.scene.rods.points
        return row.evaluations * (points**2 + BESIDE)


def _own(axis, errors):
    """Return the error of a reference from that of the next best run.

    In time and of bodies: the whole difference, an upper bound. Along rods: a third of it, for
    order 2.
    """
    if axis != "points":
        return errors
    return Errors(*(None if value is None else value / 3.0 for value in vars(errors).values()))
