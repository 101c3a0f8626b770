"""A stored run -> the scene it ran: from the output file alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rodsim.case import Case, case_from_mapping
from rodsim.errors import CaseError, FileError
from rodsim.forces.contact import contact_diameter
from rodsim.scene.bodies import stored_nodes
from rodsim.scene.build import build_scene, epsilon_of
from rodsim.scene.device import on_device
from rodsim.scene.neighbours import hydrodynamic_diameter
from rodsim.scene.state import Scene, State


def restore_scene(run, device=None) -> Scene:
    """Return the scene of a stored run, its first frame as the initial state, without tracers.

    ``run`` is what :func:`rodsim.open_trajectory` returns. Rods are as the file records them, so
    that a shape file the case names need not be there any more. ``device``: on which its sums are
    computed. Raises FileError.
    """
    if run.frames == 0:
        raise FileError(f"{run.path}: has no frames yet ({run.status})")
    case, first = restore_case(run), stored_state(run, 0)
    case = on_device(case.model_copy(update={"tracers": {}}), device)
    try:
        scene = build_scene(case, _Frame(run, first))
    except (ValueError, CaseError) as error:
        raise FileError(f"{run.path}: damaged: the case in it cannot be used: {error}") from error
    if scene.rods != run.rods:
        raise FileError(f"{run.path}: damaged: its rods are not those of its case")
    return replace(scene, initial=replace(first, work=scene.initial.work))


def scene_at(run, case: Case, frame: int) -> Scene:
    """Return the scene of a case that starts from a frame of a stored run, without tracers.

    ``case`` has the rods of the run; what is natural to them is what it was there. Raises CaseError
    and FileError.
    """
    names = {rod.name for rod in run.rods}
    if names != case.rods.keys():
        raise FileError(f"{run.path}: has the rods {', '.join(sorted(names))}: not the case's")
    if not -run.frames <= frame < run.frames:
        raise FileError(f"{run.path}: frame {frame} of {run.frames} does not exist")
    state = stored_state(run, frame)
    scene = build_scene(case.model_copy(update={"tracers": {}}), _Frame(run, state))
    return replace(scene, initial=replace(state, time=0.0, work=scene.initial.work))


def restore_case(run) -> Case:
    """Return the case of a stored run, which has all its rods; FileError where it has not."""
    try:
        case = case_from_mapping(run.case_data(), path=str(run.path))
        missing = {rod.name for rod in run.rods} - case.rods.keys()
        if missing:
            raise ValueError(f"it has no rod {', '.join(sorted(missing))}")
    except (ValueError, TypeError, RecursionError, CaseError) as error:
        raise FileError(f"{run.path}: damaged: the case in it cannot be used: {error}") from error
    return case


def stored_diameter(run, case: Case) -> float:
    """Return how thick the rods of a stored run are: to each other, or else to the fluid."""
    epsilon = epsilon_of(case, run.rods)[0]
    if case.contact is not None:
        return contact_diameter(case.contact, case.fluid.blob, epsilon)
    return hydrodynamic_diameter(case.fluid.blob, epsilon)


def stored_state(run, frame: int, ledger: int = 0) -> State:
    """Return the positions and triads of one frame as a state without tracers.

    ``ledger`` : how many numbers the ledger of its scene has; they are 0.
    """
    places, triads = stored_nodes(run, frame)
    position = np.ascontiguousarray(np.hstack([run.read("position", frame).T, places]))
    director = run.read("director", frame).transpose(1, 2, 0)
    director = np.ascontiguousarray(np.concatenate([director, triads], axis=2))
    return State(float(run.time[frame]), position, director, np.zeros((3, 0)), np.zeros(ledger))


class _Frame:
    """A frame of a stored run in place of the shapes of its rods, see ``build_rods``."""

    def __init__(self, run, state):
        self.arrays = run.arrays
        self.surface = run.surface
        self._rods, self._state = {rod.name: rod for rod in run.rods}, state

    def shape(self, name, shape):
        """Return position, director, spacing, closed of a rod."""
        rod, state = self._rods[name], self._state
        return (
            state.position[:, rod.nodes],
            state.director[:, :, rod.nodes],
            rod.spacing,
            rod.closed,
        )
