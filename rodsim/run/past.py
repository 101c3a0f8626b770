"""A run that has ended, read from its file to go on: its case, its last snapshot, its writer."""

from __future__ import annotations

import json
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

import rodsim
from rodsim.case import Case, case_from_mapping
from rodsim.case.words import shown
from rodsim.compiled.settings import machine
from rodsim.errors import CaseError, FileError, Problem
from rodsim.output import CaseText, Trajectory, open_trajectory
from rodsim.output.paths import OutputLock
from rodsim.output.reopen import extend, note_resume, reopen
from rodsim.output.verify import whole_frames
from rodsim.run.device import before, case_to_go_on, name_of
from rodsim.run.recorder import frame_times, plan_output
from rodsim.scene.device import machine_of
from rodsim.scene.inputs import CHANGED, look_again, stored_digests
from rodsim.scene.restore import stored_state

ALLOWED = (
    "a run that goes on can have a later time.end and more output.fields, nothing else; "
    "for another case use rodsim run"
)


@contextmanager
def open_past(path, overrides=()):
    """Lock an output and yield its :class:`Past`; the lock goes on to its writer."""
    path = Path(path)
    if not path.is_file():
        raise FileError(f"{path}: no such file")
    lock = OutputLock(path)
    lock.acquire()
    try:
        with open_trajectory(path) as run:
            yield _read(path, run, tuple(overrides), lock)
    finally:
        lock.release()  # does nothing where the writer has given it back


@dataclass
class Past:
    """What an output says about its run. ``case`` has the changes that were asked for.

    ``whole`` frames, from the first, are good; ``snapshot`` is of a time when there were no more,
    so that those that are damaged are written again.
    """

    path: Path
    run: Trajectory
    lock: OutputLock
    case: Case
    overrides: tuple[str, ...]
    snapshot: dict
    changed: bool
    whole: int

    @property
    def complete(self) -> bool:
        """Whether nothing is left to do."""
        run = self.run
        done = run.status == "finished" and run.frames == len(run.planned)
        return not self.changed and done and self.whole == run.frames

    def go_on_at(self, device: str | None) -> None:
        """Choose where its sums are computed: None for the device that the file names."""
        self.case = case_to_go_on(self.case, self.run, device)

    def warnings(self):
        """Yield what may keep the result from being that of an uninterrupted run, bit for bit."""
        here = {"rodsim": rodsim.__version__, **machine(), **machine_of(self.case)}
        there = {"rodsim": self.run.version, **self.run.runtime}
        here["device"], there["device"] = name_of(self.case), before(self.run)
        known = [name for name in here if there.get(name, here[name]) != here[name]]
        if known:
            was, now = (", ".join(f"{name} {at[name]}" for name in known) for at in (there, here))
            yield (
                f"{self.path} was written with {was}, this is {now}: last digits can differ from "
                "those of one run"
            )
        inputs = look_again(stored_digests(self.run.inputs), self.case.resolved())
        for file in dict.fromkeys(file for file, state in inputs.values() if state == CHANGED):
            yield f"{file} has changed since this run began; it goes on from what it began with"
        if self.whole < self.run.frames:
            yield (
                f"{self.path}: frame {self.whole} is damaged; all from frame "
                f"{self.snapshot['frames']} on are written again"
            )

    def arrays(self, name: str) -> dict:
        """Return what the strain twist of a rod was made from."""
        return self.run.arrays(name)

    def surface(self, name: str):
        """Return the points (n, 3) of a body whose surface came from a file, else None."""
        return self.run.surface(name)

    def shape(self, name: str, shape):
        """Return position, director, spacing, closed of a rod that began as a file, else None."""
        if shape.kind not in ("file", "curve"):
            return None
        rod = next(rod for rod in self.run.rods if rod.name == name)
        position = np.array(self.snapshot["position"][:, rod.nodes])
        director = np.array(self.snapshot["director"][:, :, rod.nodes])
        return position, director, rod.spacing, rod.closed

    def writer(self, machine):
        """Return the writer that goes on with the file, or with a longer copy in its place."""
        run, scene = self.run, machine.system.scene
        text = CaseText(
            run.case_source,
            json.dumps(self.case.resolved(), indent=1),
            [*run.overrides, *self.overrides],
            run.inputs,
        )
        plan = plan_output(self.case, scene, self.snapshot)
        plan = replace(plan, case=text, times=self._times())
        beyond = plan.extra_stored()  # a file of an older version may lack some of it
        kept = (e for e, s in zip(plan.extra, beyond, strict=True) if run.stores(s.where))
        plan = replace(plan, extra=tuple(kept))
        if plan.rods != run.rods:
            raise FileError(f"{self.path}: damaged: its rods are not those of its case")
        history = self._history()
        if self.changed or (plan.device and "device" not in run.runtime):
            writer = extend(self.path, plan, self.lock, run, self._compute(machine.system))
            run.close()
        else:
            run.close()  # HDF5 does not open a file for writing that it has open for reading
            writer = reopen(self.path, plan, self.lock)
        note_resume(writer, history)
        return writer

    def _times(self):
        """Return the times of all frames: those that are there stay."""
        run = self.run
        if not self.changed:
            return run.planned
        times = frame_times(self.case.time.end, self.case.interval)
        return np.append(run.time, times[times > run.time.max(initial=-1.0) * (1.0 + 1e-9)])

    def _compute(self, system):
        """Return the function that computes the fields of an earlier frame from its triads."""
        run, ledger = self.run, system.scene.ledger

        def fields(index):
            return system.observe(stored_state(run, index, ledger))[0]

        return fields

    def _history(self):
        now = datetime.now(UTC).isoformat(timespec="seconds")
        changes = "".join(f" --set {text}" for text in self.overrides)
        if (now_on := name_of(self.case)) != before(self.run):
            changes = f" --device {self.case.device} ({now_on}){changes}"
        at = f"from t = {self.snapshot['time']:.6g}, {self.run.frames} frames"
        return f"{now} {at}, was {self.run.status}; rodsim {rodsim.__version__}{changes}"


def _read(path, run, overrides, lock):
    if "residual" in run.observables:
        again = f"rodsim run CASE.yaml --from {path}"
        raise FileError(f"{path}: is no run, but states at rest; a run can start there: {again}")
    whole = whole_frames(run)
    snapshot = run.checkpoint(whole)
    if snapshot is None and whole < run.frames and run.checkpoint() is not None:
        raise FileError(
            f"{path}: damaged: frame {whole} is not whole, and no checkpoint is from before it: "
            "run the case again"
        )
    if snapshot is None or not {"time", "position", "director", "force"} <= snapshot.keys():
        raise FileError(f"{path}: damaged: neither of its checkpoints is whole")
    resolved = run.case_data()
    try:
        before = case_from_mapping(resolved, path=f"{path}: case")
    except (ValueError, TypeError, CaseError) as error:
        raise FileError(f"{path}: damaged: its case cannot be read ({error})") from error
    case = case_from_mapping(resolved, overrides, path=f"{path}: case")
    problems = [*_forbidden(path, before.resolved(), case.resolved()), *_not_computable(run, case)]
    if problems:
        raise CaseError(problems)
    changed = case.resolved() != before.resolved()
    return Past(path, run, lock, case, overrides, snapshot, changed, whole)


def _forbidden(path, before, after):
    """Yield a problem for each difference that a run which goes on cannot have."""
    for key in sorted(_leaves(before).keys() | _leaves(after).keys()):
        old, new = _leaves(before).get(key), _leaves(after).get(key)
        later = key == "time.end" and new >= old
        added = key == "output.fields" and set(new) >= set(old)
        if old != new and not later and not added:
            reason = f"is {shown(old) or 'not there'} in {path}: {ALLOWED}"
            yield Problem("--set", key, shown(new), reason)


def _leaves(node, path=""):
    """Return the values of nested mappings by dotted path; lists are values."""
    if not isinstance(node, dict):
        return {path: node}
    found = {}
    for key, item in node.items():
        found |= _leaves(item, f"{path}.{key}" if path else key)
    return found


def _not_computable(run, case):
    added = set(case.output.fields) - set(run.fields)
    if added and "director" not in run.fields and run.frames:
        what = ", ".join(sorted(added))
        reason = f"the frames of {run.path} have no director, so {what} cannot be computed for them"
        yield Problem("--set", "output.fields", shown(list(case.output.fields)), reason)
