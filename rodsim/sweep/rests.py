"""A sweep of states at rest: each found from its case, or from the one before it."""

from __future__ import annotations

import uuid
from dataclasses import replace

from rodsim.case import case_from_mapping
from rodsim.case.starts import start_in
from rodsim.errors import DivergedError, FileError
from rodsim.scene.inputs import digests
from rodsim.sweep.plan import Plan
from rodsim.sweep.work import work
from rodsim.sweep.workers import dismiss

PREVIOUS = "previous"


def as_rests(plan: Plan, origin: str | None, options: tuple[str, ...] = ()) -> Plan:
    """Return a plan whose runs are searches for rest.

    origin : None, the shapes of the case; an output, its shapes; ``previous``: each but the first
    starts from the rest that was found before it. options : of ``rodsim rest``.
    """
    runs = []
    for run in plan.runs:
        source = runs[-1].output if origin == PREVIOUS and runs else origin
        data = run.data
        if source not in (None, PREVIOUS):
            data = case_from_mapping(data, [start_in(source, -1)]).resolved()
        inputs = digests(data, run.folder)
        runs.append(replace(run, verb="rest", options=options, data=data, inputs=inputs))
    return Plan(runs, plan.key_units)


def follow(runs, threads, alone, ended, asked, display) -> None:
    """Find the rests of a chain one after another; KeyboardInterrupt where it is asked to stop.

    ``ended(run, failure)`` is called for each, as by :class:`rodsim.sweep.schedule.Sweep`.
    """
    token = uuid.uuid4().hex
    for run in runs:
        if asked():
            raise KeyboardInterrupt
        try:
            code, said = work(token, run, threads, alone)
        except FileError as error:
            code, said = error.exit_code, str(error)
        came_out = code in (0, DivergedError.exit_code)
        ended(run, None if came_out else said or f"its command ended with code {code}")
        display.look()
    dismiss(token)
