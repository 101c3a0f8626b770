"""One row for each run: what it was, how it ended, what came out. Read from the outputs alone."""

from __future__ import annotations

import csv
import json
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, field
from time import monotonic
from typing import Any

import numpy as np

from rodsim.analysis.energy import PARTS
from rodsim.analysis.periods import period_of
from rodsim.analysis.swimming import mean_rate, swimming_velocity
from rodsim.errors import FileError, SweepError, UsageError
from rodsim.files import replacing
from rodsim.output import open_trajectory
from rodsim.sweep.at_rest import RESTS, SHOWN_AT_REST, total_energy
from rodsim.sweep.measured import Measured
from rodsim.sweep.plan import Plan, Run
from rodsim.sweep.standing import opened
from rodsim.sweep.work import last_line
from rodsim.units import unit_text

VELOCITY, ENERGY = (0, 1, -1), (1, 2, -2)
RESULTS = {  # column -> dimension
    "status": (0, 0, 0),
    "time": (0, 0, 1),
    "speed": VELOCITY,
    **{f"velocity_{axis}": VELOCITY for axis in "xyz"},
    **{f"{part}_energy": ENERGY for part in (*PARTS, "elastic", "kinetic")},
    "error": (0, 1, 0),
    "evaluations": (0, 0, 0),
    "wall_seconds": (0, 0, 0),
    "message": (0, 0, 0),
}
SECONDS_BETWEEN_TABLES = 1.0
FORMULA = ("=", "+", "-", "@", "\t", "\r")  # what a spreadsheet takes a text for that begins so
SHOWN = ("status", "time", "speed", "elastic_energy", "error", "wall_seconds")  # on the terminal


@dataclass
class Summary:
    """The table of a sweep, and how its rows are made.

    ``period`` : expression in the parameters; the speed is then that over whole periods after the
    first, otherwise that over the whole run. ``reference`` : an output file; the error is then the
    largest distance of a point from where it is there, at the end of both. ``measures`` : names of
    quantities, see :mod:`rodsim.analysis.measures`, that make further columns.
    """

    plan: Plan
    period: str | None = None
    reference: Any = None
    measures: tuple[str, ...] = ()
    rows: dict[str, dict[str, Any]] = field(default_factory=dict)

    def __post_init__(self):
        self._next = 0.0
        self._measured = Measured(self.measures, self.plan)
        self.at_rest = all(run.verb == "rest" for run in self.plan.runs)
        self.results = RESTS if self.at_rest else RESULTS
        self._reference = _last_frame(self.reference) if self.reference else None
        for run in self.plan.runs:
            _period(self.period, run)  # a wrong expression shows before the runs, not after
            self.update(run)

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        results = list(self.results)
        place = results.index("error") if "error" in results else len(results)
        results[place:place] = self._measured.columns
        return ["run", *self.plan.key_units, *results]

    def unit(self, column: str) -> str:
        """Return the unit of a column, "" where it has none."""
        if column in self.results:
            return unit_text(self.results[column], self.plan.runs[0].data["units"])
        return self.plan.key_units.get(column, self._measured.columns.get(column, ""))

    def head(self, column: str) -> str:
        """Return the head of a column, with its unit."""
        unit = self.unit(column)
        return f"{column} ({unit})" if unit not in ("", "1") else column

    def column(self, name: str) -> str:
        """Return the column that a name stands for, ``parameters.b`` or its end, ``b``."""
        if name in self.columns:
            return name
        found = [c for c in self.columns if c.endswith(f".{name}")]
        if len(found) > 1:
            raise UsageError(f"column {name}: say which, {' or '.join(found)}")
        if not found:
            raise UsageError(f"no column {name}: there is {', '.join(self.columns)}")
        return found[0]

    def update(self, run: Run, failure: str | None = None) -> dict[str, Any]:
        """Read a run anew; ``failure`` is why its command could not do it. Returns its row."""
        with opened(run) as (status, output):
            row = {"run": run.name, **run.values, "status": "failed" if failure else status}
            try:
                if status not in ("waiting", "running"):  # of what goes on the numbers are half-way
                    row |= self._results(run, output)
            except UsageError as error:  # of a quantity of the user's own: the runs go on
                row["message"] = str(error)
        if failure or status == "diverged":
            begins = "" if self.at_rest else "diverged in step"
            row["message"] = failure or last_line(run.log, begins)
        self.rows[run.name] = row
        return row

    def _results(self, run, output):
        if not output.frames:
            return {}
        energies = {
            name: float(output.observable(name, -1).sum())
            for name in output.observables
            if name in self.results
        }
        energies["elastic_energy"] = sum(energies[f"{part}_energy"] for part in PARTS)
        if self.at_rest:
            energies["total_energy"] = total_energy(output)
        period = _period(self.period, run)
        velocity = _velocity(output, period)
        cost = {k: v for k, v in output.runtime.items() if k in self.results}
        found = {"time": float(output.time[-1]), **velocity, **energies, **cost}
        found |= self._error(output)
        named = {name: value for name, value in found.items() if name in self.results}
        return named | self._measured.of(output, period)

    def _error(self, output):
        if self._reference is None:
            return {}
        time, position = self._reference
        if position.shape != (output.points, 3) or abs(output.time[-1] - time) > 1e-9 * time:
            return {}
        distance = np.linalg.norm(output.read("position", -1) - position, axis=1)
        return {"error": float(distance.max())}

    def check(self) -> None:
        """Raise SweepError unless every run has finished."""
        counts = Counter(row["status"] for row in self.rows.values())
        if counts.total() > counts["finished"]:
            raise SweepError(counts)

    def write(self, path) -> None:
        """Write the table as CSV, whole or not at all."""
        with (
            replacing(path) as temporary,
            open(temporary, "w", newline="", encoding="utf-8") as out,
        ):
            table = csv.writer(out)
            table.writerow([_harmless(self.head(column)) for column in self.columns])
            for row in self.rows.values():
                table.writerow([_harmless(as_cell(row.get(column, ""))) for column in self.columns])

    def write_now_and_then(self, path) -> None:
        """Write the table unless it was written a moment ago: all of it at every end is N squared.

        One that cannot be written is none of the runs' concern; the last one will tell.
        """
        if monotonic() >= self._next:
            with suppress(FileError):
                self.write(path)
            self._next = monotonic() + SECONDS_BETWEEN_TABLES

    def text(self) -> str:
        """Return the most important columns as aligned text."""
        present = set().union(*self.rows.values())
        shown = SHOWN_AT_REST if self.at_rest else SHOWN
        shown = [c for c in shown if c not in self._measured.columns]
        columns = [*self.plan.key_units, *shown[:-1], *self._measured.columns, shown[-1]]
        columns = [c for c in columns if c in present]
        cells = [[self.head(c) for c in columns]]
        cells += [[short(row.get(c, "")) for c in columns] for row in self.rows.values()]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        lines = ["  ".join(c.rjust(w) for c, w in zip(line, widths, strict=True)) for line in cells]
        return "\n".join(lines)


def _velocity(output, period):
    """Return speed and velocity of the centroid of all points, where frames allow."""
    if output.frames < 2:
        return {}
    try:
        velocity = (
            swimming_velocity(output.time, output.position, period)
            if period
            else mean_rate(output.time, output.position.mean(axis=1))
        )
    except UsageError:  # stopped or diverged before the second period was whole
        return {}
    named = {f"velocity_{axis}": float(v) for axis, v in zip("xyz", velocity, strict=True)}
    return {"speed": float(np.linalg.norm(velocity)), **named}


def _period(text, run):
    """Return the period of a run, or None where none is given."""
    return text and period_of(text, run.data["parameters"], f" for the run {run.name}")


def _last_frame(path):
    with open_trajectory(path) as output:
        if not output.frames:
            raise FileError(f"{path}: has no frames")
        return float(output.time[-1]), output.read("position", -1)


def as_cell(value) -> str | int:
    """Return a value as the table has it, with all its digits."""
    if isinstance(value, float):
        return repr(value)
    return value if isinstance(value, str | int) else json.dumps(value)


def _harmless(cell):
    """Return a cell that no spreadsheet runs as a formula: a text, with a quote before it."""
    formula = isinstance(cell, str) and cell.startswith(FORMULA) and not _is_number(cell)
    return f"'{cell}" if formula else cell


def _is_number(text):
    try:
        return bool(float(text) or True)
    except ValueError:
        return False


def short(value) -> str:
    """Return a value as people read it."""
    return f"{value:.5g}" if isinstance(value, float) else str(as_cell(value))
