"""From names of quantities and an open run to numbers: over time, or one for the whole run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rodsim.analysis.measures import MEASURES, Measure, others
from rodsim.analysis.own import own_measure
from rodsim.analysis.subjects import KINDS, Frame
from rodsim.analysis.swimming import whole_periods
from rodsim.analysis.table import Column, Table
from rodsim.case.words import clipped, did_you_mean
from rodsim.errors import FileError, UsageError
from rodsim.progress import Silent


@dataclass(frozen=True)
class Picked:
    """A quantity of one subject: of ``subject``, a rod or the like, whose name is ``of``."""

    measure: Measure
    of: str
    subject: Any = None

    @property
    def names(self) -> list[str]:
        """Names of its columns: ``tail.speed``, or one for each component of a vector."""
        name = f"{self.of}.{self.measure.name}" if self.of else self.measure.name
        return [f"{name}_{part}" for part in self.measure.components] or [name]

    def columns(self, units: dict) -> list[Column]:
        """Return the heads of its columns."""
        unit, parts = self.measure.unit_in(units), self.measure.components or ("",)
        labels = [" ".join(filter(None, (self.of, part))) for part in parts]
        pairs = zip(self.names, labels, strict=True)
        return [Column(name, unit, self.measure.name, label) for name, label in pairs]


def parse(text: str, known: dict[str, Measure]) -> tuple[str, Measure]:
    """Return (rod or the like, quantity) of ``speed``, ``tail.speed`` or ``my.py:function``.

    The first is an empty text where all are meant. ``known`` : the quantities by name. Raises
    UsageError.
    """
    if ":" in text:
        return "", own_measure(text)
    of, _, name = text.rpartition(".")
    if name not in known:
        near = did_you_mean(name, known) or f": there is {', '.join(known)}; or FILE.py:FUNCTION"
        raise UsageError(f"no quantity '{clipped(name)}'{near}")
    return of, known[name]


def pick(run, texts, rods=()) -> list[Picked]:
    """Return the quantities that are asked for, of every subject that has them.

    ``rods`` : names, where only some are wanted. Raises UsageError for names that are not known,
    and where nothing has a quantity; FileError where the file lacks what it needs.
    """
    known = {**MEASURES, **others(run)}
    _check_names("rod", rods, [rod.name for rod in run.rods])
    found = [picked for text in texts for picked in _of(run, *parse(text, known), rods)]
    return list({name: picked for picked in found for name in [picked.names[0]]}.values())


def available(run) -> list[Measure]:
    """Return the quantities that a file has, of one subject at least."""
    measures = (*MEASURES.values(), *others(run).values())
    return [m for m in measures if not m.lacks(run) and any(map(m.fits, _subjects(run, m)))]


def _subjects(run, measure):
    return KINDS[measure.per].of_run(run).values()


def _of(run, of, measure, rods):
    """Return the subjects of one quantity."""
    if reason := measure.lacks(run):
        raise FileError(f"{run.path}: no {measure.name}: {reason} (docs/measure.md)")
    subjects = KINDS[measure.per].of_run(run)
    if of:
        _check_names(measure.per, [of], list(subjects))
    wanted = [of] if of else [n for n in subjects if not rods or measure.per != "rod" or n in rods]
    found = [Picked(measure, n, subjects[n]) for n in wanted if measure.fits(subjects[n])]
    if not found:
        names = ", ".join(wanted)
        raise UsageError(f"{measure.name} is of {measure.rods} rods, which {names} is not")
    return found


def _check_names(kind, names, known):
    for name in names:
        if name not in known:
            near = did_you_mean(name, known) or f": there is {', '.join(known)}"
            raise UsageError(f"no {kind} '{clipped(name)}'{near}")


def over_time(run, picked, every=1, progress=None) -> Table:
    """Return the quantities at every ``every``-th frame; raises FileError without frames.

    Every frame is read where a quantity follows from its neighbours, as a speed does.
    """
    needed = 1 if any(p.measure.series for p in picked) else every
    frames = range(0, run.frames, needed)
    values, time = _at(run, picked, frames, progress), run.time[frames]
    rows = slice(None, None, every // needed)
    columns = [_series(run, p, time, v)[rows] for p, v in zip(picked, values, strict=True)]
    heads = tuple(column for p in picked for column in p.columns(run.units))
    flat = [column.reshape(len(time[rows]), -1) for column in columns]
    return Table(heads, time[rows], np.concatenate(flat, axis=1), run.units["time"])


def of_run(run, picked, period: float | None = None) -> dict[str, float]:
    """Return one number of each column for the whole run, see ``Measure.whole``.

    ``period`` : means are then those over the whole periods after the first.
    """
    chosen = slice(None) if period is None else whole_periods(run.time, period)
    long = [p for p in picked if p.measure.number]
    values = dict(zip(map(id, long), _at(run, long, range(run.frames)), strict=True))
    found = {}
    for p in picked:
        if p.measure.number:
            few = run.time[chosen], values[id(p)][chosen]
            number = p.measure.number(*few, p.subject, run)
        else:
            last = _at(run, [p], range(run.frames)[-1:])[0]
            number = _series(run, p, run.time[-1:], last)[-1]
        found |= zip(p.names, np.ravel(number).astype(float).tolist(), strict=True)
    return found


def measure(run, name: str, rod: str = "") -> np.ndarray:
    """Return one quantity at every frame: (T,) or, for a vector, (T, 3).

    ``rod`` : the one it is of; left out, and not in the name either, there is one column for each
    rod, (T, R) or (T, R, 3), NaN where a rod has none. Raises as :func:`pick` does.
    """
    of, measured = parse(name, {**MEASURES, **others(run)})
    if rod and (measured.per != "rod" or of not in ("", rod)):
        raise UsageError(f"{name} is not of the rod {rod}: run.measure({name!r}) has it")
    picked = pick(run, [name], [rod] if rod else ())
    parts = max(1, len(measured.components))
    values = over_time(run, picked).values.reshape(run.frames, len(picked), parts)
    if not (rod or of or measured.per == "scene"):
        names = list(KINDS[measured.per].of_run(run))
        found = np.full((run.frames, len(names), parts), np.nan)
        found[:, [names.index(p.of) for p in picked]] = values
        values = found
    else:
        values = values[:, 0]
    return values if measured.components else values[..., 0]


def _series(run, picked, time, values):
    series = picked.measure.series
    return series(time, values, picked.subject, run) if series else values


def _at(run, picked, frames, progress=None):
    """Return the values of each quantity at some frames, (F, ...) each."""
    if not run.frames:
        raise FileError(f"{run.path}: has no frames yet ({run.status})")
    progress, rows, kept = progress or Silent(), [], {}
    for number in frames if picked else ():
        frame = Frame(run, number, kept)
        places = (KINDS[p.measure.per].at(frame, p.subject) for p in picked)
        rows.append([p.measure.frame(place) for p, place in zip(picked, places, strict=True)])
        progress.update((number + 1) / run.frames, f"t = {frame.time:.4g}")
    return [np.array(column, dtype=float) for column in zip(*rows, strict=True)]
