"""What a study says: a table on the terminal, rows in a CSV file, a picture."""

from __future__ import annotations

import csv

import numpy as np

from rodsim.case.methods import ADAPTIVE, FIXED_STEP
from rodsim.convergence.outcome import swims
from rodsim.convergence.study import Result, Section, Study
from rodsim.errors import FileError

NEAR = 2.0  # times the reference's own error, or rounding's: below it an error is not a row's own
METHODS = (*ADAPTIVE, *sorted(FIXED_STEP))  # in the order of the table
HEADS = {
    "time": "error against run time: tolerance of rkc, step of euler and rk4",
    "points": "error of the discretisation: points at fixed length and epsilon",
    "body_points": "error of the surfaces: points of bodies, all else fixed",
    "accuracy": "error of fast sums: their accuracy",
    "epsilon": "sensitivity to epsilon: another blob is another model, this is no error",
}


def fitted_order(section: Section, method: str) -> float | None:
    """Return the slope of the largest position error against the step or spacing of a method.

    Least squares on logarithms over the rows well above the reference's own error; for rkc in
    time against the mean accepted step. None with fewer than two such rows.
    """
    floor = NEAR * section.floor
    pairs = [
        (_size(section, result), result.errors.position)
        for result in section.results
        if result.row.method == method and result.errors and result.errors.position > floor
    ]
    if section.axis in ("epsilon", "accuracy") or len(pairs) < 2:
        return None
    size, error = np.log(pairs).T
    return float(np.polyfit(size, error, 1)[0])


def _size(section, result):
    if section.axis == "points":
        return 1.0 / result.outcome.scene.rods.segments.sum()
    if section.axis == "body_points":
        return result.row.value**-0.5
    return 1.0 / result.outcome.steps


def text(study: Study) -> str:
    """Return every section as aligned text, each with its reference and the orders seen."""
    return "\n\n".join(
        "\n".join([*_section(study, section), *_choice(study, section)])
        for section in study.sections
    )


def _section(study, section):
    unit, moving = study.case.units.length, swims(study.scene)
    carries = study.scene.initial.tracer.size > 0
    yield HEADS[section.axis]
    own = "" if section.own is None else f": good to {section.own.position:.1e} {unit}"
    yield f"reference: {section.reference}{own}"
    if section.amplified:
        apart = f"{section.rounding:.1e} {unit}"
        yield f"no bound: rounding is amplified, starts a last bit apart end {apart} apart"
    yield f"largest and rms distance in {unit}, {_clock(study)}; energy over the larger of its"
    yield "first and last value, speed over itself; ~: no larger than what the reference may err"
    parts = [r.row.part for r in section.results if r.outcome and r.row.part < 1.0]
    if parts:
        yield f"*: only the first {parts[0]:.0%} was run (--whole: all): cost in proportion, and as"
        yield "   much of the error of euler's longest step, which was run to the end, as there"
    names = ["method", "value", "largest", "of length", "rms", "angle/deg", "energy"]
    names += (
        ["speed"] * moving + ["tracers"] * carries + ["solve/s", "evaluations", "pairs x evals"]
    )
    yield "  ".join(f"{name:>13}" for name in names)
    for result in sorted(section.results, key=_order):
        yield "  ".join(f"{cell:>13}" for cell in _cells(section, result, moving, carries))
    for method in dict.fromkeys(result.row.method for result in section.results):
        order = fitted_order(section, method)
        if order is not None:
            what = {"points": "space", "body_points": "surfaces"}.get(section.axis, method)
            yield f"observed order of {what}: {order:.2f}"


def _clock(study):
    """Say what the wall time of a row was taken of."""
    at_once = study.side_by_side
    if at_once == 1:
        return "wall time in seconds"
    return f"wall time in seconds on {study.threads or 1} of the cores, {at_once} rows at once"


def _order(result):
    return METHODS.index(result.row.method), -result.row.value


def _cells(section, result, swims, carries):
    head = [result.row.method, f"{result.row.value:.6g}"]
    if result.outcome is None:
        return [*head, result.status]
    run, e = result.outcome, result.errors
    cost = [f"{run.best:.3g}", str(run.evaluations),
            f"{run.evaluations * run.pairs:.3g}"]  # fmt: skip
    if e is None:
        return [*head, "reference", *[""] * (4 + swims + carries), *cost]
    near = section.own is not None and e.position < NEAR * section.floor
    largest = "*" * (result.row.part < 1.0) + "~" * near + f"{e.position:.2e}"
    more = [f"{x:.2e}" for x, there in ((e.speed, swims), (e.tracers, carries)) if there]
    sizes = [f"{x:.2e}" for x in (e.relative, e.rms, e.angle, e.energy)]
    return [*head, largest, *sizes, *more, *cost]


def _choice(study, section):
    """Yield, for every decade of error, the fastest run of each method within it."""
    if section.axis != "time":
        return
    done = [r for r in section.results if r.errors and r.errors.position > 0.0]
    methods = sorted({r.row.method for r in done}, key=METHODS.index)
    if not done:
        return
    errors = [max(r.errors.position, section.floor) for r in done]  # what can be told of them
    best, worst = min(errors), max(errors)
    yield "fastest run of each method within"
    for decade in range(int(np.ceil(np.log10(worst))), int(np.floor(np.log10(best))), -1):
        fastest = {}
        for method in methods:
            within = [r for r in done if r.row.method == method and r.errors.position <= 10**decade]
            if within:
                fastest[method] = min(within, key=lambda r: r.outcome.best)
        yield f"  1e{decade:+03d} {study.case.units.length}:  " + ";  ".join(_named(fastest))


def _named(fastest):
    first = None
    for method, result in fastest.items():
        seconds = result.outcome.best
        ratio = "" if first is None else f" = {seconds / first:.3g} times that"
        first = first or seconds
        yield f"{method} {result.row.value:g} {seconds:.3g} s{ratio}"


def _cell(value):
    return "" if value is None else value


class CsvRows:
    """Rows go to the file as they end: what an interrupted study has is kept."""

    COLUMNS = ("section", "method", "value", "status",
               "position_error", "relative_error", "rms_error", "triad_angle_degrees",
               "energy_error", "speed_error", "seconds", "seconds_high", "repeats",
               "steps", "rejected", "evaluations", "pairs",
               "reference_error", "rounding_error", "tracer_error", "part")  # fmt: skip

    def __init__(self, path):
        self.path = path
        self._write(self.COLUMNS, "x")

    def add(self, section: Section, result: Result) -> None:
        """Write one row."""
        e, run = result.errors, result.outcome
        known = [section.own.position if section.own else "", _cell(section.rounding)]
        *errors, tracers = [""] * 7 if e is None else [_cell(x) for x in vars(e).values()]
        cost = [""] * 7
        if run is not None:
            spread = run.best, max(run.seconds)
            cost = [*spread, len(run.seconds), run.steps, run.rejected, run.evaluations, run.pairs]
        row = result.row
        self._write(
            [row.axis, row.method, row.value, result.status, *errors, *cost, *known, tracers,
             row.part], "a"
        )  # fmt: skip

    def _write(self, cells, mode):
        try:
            with open(self.path, mode, newline="", encoding="utf-8") as stream:
                csv.writer(stream).writerow(cells)
        except OSError as error:
            raise FileError(f"{self.path}: cannot be written: {error.strerror}") from error
