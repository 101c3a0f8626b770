"""A stored run -> the scene it ran: from the output file alone."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np

from rodsim.case import case_from_mapping
from rodsim.errors import CaseError, FileError
from rodsim.scene.build import build_scene
from rodsim.scene.state import Scene, State


def restore_scene(run) -> Scene:
    """Return the scene of a stored run, its first frame as the initial state, without tracers.

    ``run`` is what :func:`rodsim.open_trajectory` returns. Rods are as the file records them, so
    that a shape file the case names need not be there any more. Raises FileError.
    """
    if run.frames == 0:
        raise FileError(f"{run.path}: has no frames yet ({run.status})")
    first = stored_state(run, 0)

    def stored(name, shape):
        rod = next(rod for rod in run.rods if rod.name == name)
        return (
            first.position[:, rod.nodes],
            first.director[:, :, rod.nodes],
            rod.spacing,
            rod.closed,
        )

    try:
        resolved = json.loads(run.case_resolved)
        resolved.pop("tracers", None)
        scene = build_scene(case_from_mapping(resolved, path=str(run.path)), stored)
    except (ValueError, KeyError, TypeError, RecursionError, StopIteration, CaseError) as error:
        raise FileError(f"{run.path}: damaged: the case in it cannot be used: {error}") from error
    if scene.rods != run.rods:
        raise FileError(f"{run.path}: damaged: its rods are not those of its case")
    return replace(scene, initial=replace(first, work=scene.initial.work))


def stored_state(run, frame: int, ledger: int = 0) -> State:
    """Return the positions and triads of one frame as a state without tracers.

    ``ledger`` : how many numbers the ledger of its scene has; they are 0.
    """
    position = np.ascontiguousarray(run.read("position", frame).T)
    director = np.ascontiguousarray(run.read("director", frame).transpose(1, 2, 0))
    return State(float(run.time[frame]), position, director, np.zeros((3, 0)), np.zeros(ledger))
