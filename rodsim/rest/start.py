"""What ``rest`` and ``stability`` start from: a case, or a frame of an output."""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from rodsim.case import Case, case_from_mapping
from rodsim.case.expressions import ExpressionError, names_in
from rodsim.compiled.parts import FLOW, FORCE, PLACE
from rodsim.errors import UsageError
from rodsim.output import CaseText, open_trajectory
from rodsim.scene.build import build_scene
from rodsim.scene.evaluation import Evaluation
from rodsim.scene.restore import scene_at
from rodsim.scene.state import Scene
from rodsim.text import texts_in


@dataclass(frozen=True)
class Start:
    """A case and its scene; ``text``: what the output says of the case, None as of any run."""

    case: Case
    scene: Scene
    text: CaseText | None = None


def start_from_output(path, overrides, frame: int) -> Start:
    """Return the case of a stored run, its points and triads those of a frame."""
    with open_trajectory(path) as run:
        _refuse_idle(run.case_data(), overrides)
        case = case_from_mapping(run.case_data(), overrides, path=f"{path}: case")
        scene = scene_at(run, case, frame)
        resolved = json.dumps(case.resolved(), indent=1)
        changes = [*run.overrides, *overrides]
        return Start(case, scene, CaseText(run.case_source, resolved, changes, run.inputs))


def _refuse_idle(data, overrides):
    """Raise UsageError where a parameter is set that nothing uses any more.

    What is a number in a case is worked out when the case is read, and stored as that.
    """
    used = set()
    for text in texts_in({key: item for key, item in data.items() if key != "parameters"}):
        with suppress(ExpressionError):
            used |= names_in(text)
    for text in overrides:
        section, _, name = text.partition("=")[0].strip().partition(".")
        if section == "parameters" and name not in used:
            raise UsageError(
                f"--set {text}: changes nothing, for the numbers in an output are worked out "
                "already: set what uses it, such as rods.NAME.strain_twist"
            )


def start_from_case(case: Case) -> Start:
    """Return a case and the scene that its file describes."""
    return Start(case, build_scene(case))


def at_time(start: Start, time: float | None) -> Start:
    """Return a start, forces and held ends as at one time; UsageError where that is not said."""
    scene = start.scene
    if any(part.external for part in scene.parts.of(FLOW)):
        raise UsageError("a background flow moves the rods, so they are not at rest without loads")
    driven = [part.drive for part in scene.parts.of(PLACE, FORCE) if part.row.driven]
    if driven and time is None:
        raise UsageError(f"{driven[0]} depends on time: say with --at when it is looked at")
    moment, end = 0.0 if time is None else time, start.case.time.end
    if not 0.0 <= moment <= end:  # or not a number
        raise UsageError(
            f"--at {moment:g}: not between 0 and time.end = {end:g}, where what depends on time "
            "was checked: change it, or --set time.end"
        )
    return replace(start, scene=replace(scene, initial=_held_at(scene, moment)))


def _held_at(scene, time):
    """Return the initial state at a time, its held ends where they are then."""
    state = replace(scene.initial, time=time)
    if placing := scene.parts.of(PLACE):
        state = replace(state, position=state.position.copy(), director=state.director.copy())
        loads = np.zeros((6, scene.nodes))
        Evaluation(scene, placing).add(state, loads, loads, state.tracer)
    return state
