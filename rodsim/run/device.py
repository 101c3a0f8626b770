"""The device on which a run goes on: the one that its file names, if nobody says otherwise."""

from __future__ import annotations

from rodsim.compiled.constants import CPU, GPU
from rodsim.errors import UsageError
from rodsim.output.writer import short
from rodsim.scene.device import machine_of, on_device

HOW = "go on with --device cpu; last digits can then differ from those of one run"


def before(run) -> str:
    """Return what a stored run was on: the name of a card, or cpu."""
    return run.runtime.get("device", CPU)


def case_to_go_on(case, run, asked: str | None):
    """Return the case of a stored run on the device ``asked``, None for that which its file names.

    Raises UsageError where that is not there.
    """
    there = before(run)
    if asked is not None or there == CPU:
        return on_device(case, asked)
    told = f"{run.path}: its sums were computed on {there}"
    try:
        case = on_device(case, GPU)
    except UsageError as error:
        raise UsageError(f"{told}; {error}; or {HOW}") from error
    here = name_of(case)
    if here != there:
        raise UsageError(f"{told}, here is {here}: go on there with --device gpu, or {HOW}")
    return case


def name_of(case) -> str:
    """Return what the file of a run calls the device of a case."""
    return short(machine_of(case).get("device", CPU)).decode()
