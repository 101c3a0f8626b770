"""What a study runs, axis by axis: references first, known before anything is run."""

from __future__ import annotations

from dataclasses import dataclass, replace

from rodsim.convergence import rows
from rodsim.convergence.rows import Row
from rodsim.convergence.stretch import Stretch, shorten_costly
from rodsim.errors import UsageError

TIMED = ("tolerance", "step")


@dataclass(frozen=True)
class Part:
    """The rows of a section; the first is the reference, which ``words`` describe.

    ``check``: tells how good that is; ``twin``: its steps are taken again from a start that
    differs in the last bit; ``stretch``: what rows that are not run to the end are held against.
    """

    axis: str
    words: str
    rows: list[Row]
    check: Row | None = None
    twin: Row | None = None
    stretch: Stretch | None = None

    @property
    def all_rows(self) -> list[Row]:
        """Every run of it."""
        more = [self.check, self.twin]
        if self.stretch:
            more += [self.stretch.reference, self.stretch.guide_part]
        return [*self.rows, *(row for row in more if row)]


def plan(case, scene, limits, axes, whole=False) -> list[Part]:
    """Return the parts of a study in order; ``whole``: all rows to their end.

    Raises UsageError for an axis that the scene does not have.
    """
    made, rate = [], limits.rate
    timed = [axis for axis in axes if axis in TIMED]
    twin = rows.own_row(case, rate)
    if timed:
        made.append(_time(case, limits, timed, whole))
        twin = made[0].twin  # rounding is the same in all sections
    if "points" in axes:
        _need_formulas(case)
        made.append(_points(case, rate, scene, twin))
    if "body_points" in axes:
        _need_bodies(case)
        made.append(_body_points(case, rate, twin))
    if "epsilon" in axes:
        made.append(_epsilon(case, rate, scene))
    if "accuracy" in axes:
        words = "exact sums, with the same steps"
        made.append(Part("accuracy", words, rows.accuracy_rows(case, rate)))
    return made


def _time(case, limits, timed, whole):
    """Tolerances and steps share one reference."""
    reference, check = (
        Row("time", "rkc", value, rows.rkc(value), rows.guess(case, limits.rate, value))
        for value in (
            max(rows.TIGHTEST, float(f"{case.time.tolerance * factor:.6g}"))
            for factor in (rows.REFERENCE, rows.CHECK)
        )
    )
    found, stretch = [], None
    if "tolerance" in timed:
        found += rows.tolerance_rows(case, limits.rate)
    if "step" in timed:
        fixed = rows.step_rows(case, limits)
        if not whole:
            fixed, stretch = shorten_costly(fixed, reference, case)
        found += fixed
    words = f"rkc at tolerance {reference.value:g}, held against tolerance {check.value:g}"
    return Part("time", words, [reference, *found], check, twin=check, stretch=stretch)


def _points(case, rate, scene, twin):
    found = rows.points_rows(case, rate, scene.epsilon)[::-1]
    words = f"{found[0].value:.0f} points; its error by order 2 from {found[1].value:.0f}"
    return Part("points", words, found, found[1], twin)


def _body_points(case, rate, twin):
    found = rows.body_rows(case, rate)[::-1]
    words = f"{found[0].value} points of bodies, held against {found[1].value}"
    return Part("body_points", words, found, found[1], twin)


def _epsilon(case, rate, scene):
    own = replace(rows.own_row(case, rate), axis="epsilon")
    words = f"the case's own epsilon, {scene.epsilon:.6g}"
    return Part("epsilon", words, [own, *rows.epsilon_rows(case, rate, scene.epsilon)])


def _need_formulas(case):
    for name, rod in case.rods.items():
        if rod.shape.segments is None:
            raise UsageError(
                f"points: rod '{name}' comes from a file, which gives its points once and for "
                "all: leave 'points' out of --in"
            )


def _need_bodies(case):
    bodies, formed = case.bodies or {}, rows.body_points(case)
    if not formed or len(formed) < len(bodies) or len(rows.body_rows(case, 1.0)) < 2:
        why = "a body comes from a file, which gives its points once and for all"
        if not bodies:
            why = "there are no bodies"
        elif len(formed) == len(bodies):
            why = "the bodies have as many points as there can be, or as few"
        raise UsageError(f"body_points: {why}: leave 'body_points' out of --in")
