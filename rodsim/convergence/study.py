"""The rows of a study, each held against a reference when both have ended."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from rodsim.convergence import rows
from rodsim.convergence.outcome import Errors, Outcome, compare
from rodsim.convergence.rows import Row
from rodsim.convergence.side_by_side import REFUSED, Runs
from rodsim.errors import CaseError, FileError, UsageError
from rodsim.integrators.limits import stability
from rodsim.scene.build import build_scene
from rodsim.scene.inputs import SAME, case_digests, compare_inputs
from rodsim.scene.system import RodSystem

REPEATS = 3
BESIDE = 50_000  # pairs that all but the sums takes as long as, in an evaluation
ROUNDING = 1e-12  # of the longest rod: what a last bit is after a stable run
AMPLIFIED = 0.1  # of the reference's own error: rounding is then part of it
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

    ``rounding``: how far two runs end from each other that differ in the last bit of their start.
    """

    axis: str
    reference: str
    own: Errors | None = None
    rounding: Errors | None = None
    results: list[Result] = field(default_factory=list)

    @property
    def floor(self) -> float:
        """Position error below which nothing can be told: the reference's own, or rounding's."""
        return max((e.position for e in (self.own, self.rounding) if e), default=0.0)

    @property
    def amplified(self) -> bool:
        """Whether rounding alone moves the end so far that ``own`` is no bound."""
        if not (self.own and self.rounding) or self.rounding.relative < ROUNDING:
            return False
        return self.rounding.position > AMPLIFIED * self.own.position


class Study:
    """Error against run time of a case.

    ``load(overrides)`` returns the case with more keys changed; ``axes`` are some of
    ``rows.AXES``.
    """

    def __init__(self, load: Callable, axes, threads=None, progress=None):
        self.load, self.threads, self.case = load, threads, load(())
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
        plan = self._plan()
        for row in [row for _, part in plan for row in part]:
            self._ask(row)
        for row in [row for _, part in plan for row in part[1:] if self._is_twin(row)]:
            self._ask(row, nudged=True)
        with self._runs:
            for section, part in plan:
                yield from self._section(section, part)

    @property
    def side_by_side(self) -> int:
        """How many runs go on at once."""
        return self._runs.side_by_side

    def _ask(self, row, nudged=False):
        """Ask for the run of a row; of one that cannot be, remember in words why not."""
        own = f"fluid.epsilon={self.scene.epsilon!r}"  # so that rows with the same case know it
        try:
            case = self.load((*rows.quiet(self.case), own, *row.overrides))
        except CaseError as error:
            self._cases[row] = f"{REFUSED}: {error.problems[0].reason}"
            return
        self._cases[row] = case
        repeats = 1 if nudged or row.axis == "time" else REPEATS
        label = f"{row.method} {row.axis} {row.value:g}"
        self._runs.ask(label, case, self._weight(row), nudged, repeats)

    def _plan(self):
        """Return (section, rows) in order; the first row of each is its reference.

        Tolerances and steps share one reference; the second row tells how good that is.
        """
        case, rate = self.case, self.limits.rate
        plan = []
        timed = [axis for axis in self.axes if axis in ("tolerance", "step")]
        if timed:
            tight, check = (
                max(rows.TIGHTEST, case.time.tolerance * factor)
                for factor in (rows.REFERENCE, rows.CHECK)
            )
            pair = [
                Row("time", "rkc", value, rows.rkc(value), rows.guess(case, rate, value))
                for value in (tight, check)
            ]
            makers = {
                "tolerance": lambda: rows.tolerance_rows(case, rate),
                "step": lambda: rows.step_rows(case, self.limits),
            }
            found = [row for axis in timed for row in makers[axis]()]
            words = f"rkc at tolerance {tight:g}, held against tolerance {check:g}"
            plan.append((Section("time", words), [*pair, *found]))
        if "points" in self.axes:
            self._need_formulas()
            found = rows.points_rows(case, rate, self.scene.epsilon)
            words = f"{found[-1].value:.0f} points; its error by order 2 from {found[-2].value:.0f}"
            plan.append((Section("points", words), found[::-1]))
        if "body_points" in self.axes:
            self._need_bodies()
            found = rows.body_rows(case, rate)
            words = f"{found[-1].value} points of bodies, held against {found[-2].value}"
            plan.append((Section("body_points", words), found[::-1]))
        if "epsilon" in self.axes:
            own = Row("epsilon", "rkc", self.scene.epsilon, rows.rkc(rows.SPACE_TOLERANCE),
                      rows.guess(case, rate, rows.SPACE_TOLERANCE))  # fmt: skip
            words = f"the case's own epsilon, {self.scene.epsilon:.6g}"
            found = rows.epsilon_rows(case, rate, self.scene.epsilon)
            plan.append((Section("epsilon", words), [own, *found]))
        if "accuracy" in self.axes:
            words = "exact sums, with the same steps"
            plan.append((Section("accuracy", words), rows.accuracy_rows(case, rate)))
        return plan

    def _need_formulas(self):
        for name, rod in self.case.rods.items():
            if rod.shape.segments is None:
                raise UsageError(
                    f"points: rod '{name}' comes from a file, which gives its points once and for "
                    "all: leave 'points' out of --in"
                )

    def _need_bodies(self):
        bodies, formed = self.case.bodies or {}, rows.body_points(self.case)
        if not formed or len(formed) < len(bodies) or len(rows.body_rows(self.case, 1.0)) < 2:
            why = "a body comes from a file, which gives its points once and for all"
            if not bodies:
                why = "there are no bodies"
            elif len(formed) == len(bodies):
                why = "the bodies have as many points as there can be, or as few"
            raise UsageError(f"body_points: {why}: leave 'body_points' out of --in")

    def _section(self, section, part):
        first, *others = part
        reference = self._outcome(first)
        if not isinstance(reference, Outcome):
            raise UsageError(f"{section.axis}: the reference ({section.reference}) is {reference}")
        self.sections.append(section)
        if section.axis in ("points", "body_points", "accuracy"):
            others = [*others, first]
        for row in others:
            result = self._result(row, first, reference)
            if (
                section.own is None
                and section.axis in ("time", "points", "body_points")
                and result.errors
            ):
                section.own = _own(section, result.errors)
            if result.outcome and row is not first and self._is_twin(row):
                section.rounding = self._rounding(row, result.outcome)
            if row.axis == "time":
                continue
            section.results.append(result)
            yield section, result

    def _is_twin(self, row):
        """Tell the runs that are made again from a start that differs in the last bit.

        They are the check of the reference in time, and the case's own numbers of points.
        """
        if row.axis == "points":
            return row.value == self.scene.rods.points
        if row.axis == "body_points":
            return row.value == sum(rows.body_points(self.case).values())
        return row.axis == "time"

    def _rounding(self, row, outcome):
        twin = self._outcome(row, nudged=True)
        return compare(twin, outcome) if isinstance(twin, Outcome) else None

    def _result(self, row, first, reference):
        if row is first:
            return Result(row, reference)
        outcome = self._outcome(row)
        if not isinstance(outcome, Outcome):
            return Result(row, status=outcome)
        return Result(row, outcome, compare(outcome, reference))

    def _outcome(self, row, nudged=False):
        """Return the outcome of a row, or in words why there is none."""
        case = self._cases[row]
        if isinstance(case, str):
            return case
        found = self._runs.outcome(case, nudged)
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


def _own(section, errors):
    """Return the error of a reference from that of the next best run.

    In time and of bodies: the whole difference, an upper bound. Along rods: a third of it, for
    order 2.
    """
    if section.axis != "points":
        return errors
    return Errors(*(None if value is None else value / 3.0 for value in vars(errors).values()))
