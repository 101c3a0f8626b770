"""A stored run -> the scene it ran: from the output file alone."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from rodsim.case import case_from_mapping
from rodsim.errors import CaseError, FileError
from rodsim.scene.build import _epsilon
from rodsim.scene.state import Rods, Scene, State, StrainTwist
from rodsim.scene.strain import bind


def restore_scene(run) -> Scene:
    """Return the scene of a stored run, its first frame as the initial state, without tracers.

    ``run`` is what :func:`rodsim.open_trajectory` returns. Rods are as the file records them, so
    that a shape file the case names need not be there any more. Raises FileError.
    """
    if run.frames == 0:
        raise FileError(f"{run.path}: has no frames yet ({run.status})")
    try:
        case = case_from_mapping(json.loads(run.case_resolved), path=str(run.path))
        entries = [_entries(run, case.rods[rod.name], rod) for rod in run.rods]
    except (ValueError, KeyError, TypeError, RecursionError, CaseError) as error:
        raise FileError(f"{run.path}: damaged: the case in it cannot be used: {error}") from error
    rods = _rods(run.rods)
    return Scene(
        rods=rods,
        strain_twist=StrainTwist(rods, entries),
        epsilon=_epsilon(case, rods)[0],
        viscosity=case.fluid.viscosity,
        blob=case.fluid.blob,
        planar=case.plane is not None,
        density=case.fluid.density,
        tracer_groups={},
        initial=stored_state(run, 0),
    )


def _entries(run, rod, record):
    """Return the strain twist of a rod, from the arrays that the file keeps of it."""
    no_triads = np.empty((3, 3, 0))
    kept = run.arrays(record.name) if rod.needs_data else {}
    entries, _ = bind(rod, no_triads, record.spacing, record.closed, Path(run.path).parent, kept)
    return entries


def stored_state(run, frame: int) -> State:
    """Return the positions and triads of one frame as a state without tracers."""
    position = np.ascontiguousarray(run.read("position", frame).T)
    director = np.ascontiguousarray(run.read("director", frame).transpose(1, 2, 0))
    return State(float(run.time[frame]), position, director, np.zeros((3, 0)))


def _rods(records):
    return Rods(
        names=tuple(rod.name for rod in records),
        first=np.array([rod.first for rod in records], dtype=np.int64),
        count=np.array([rod.count for rod in records], dtype=np.int64),
        closed=np.array([rod.closed for rod in records], dtype=np.bool_),
        spacing=np.array([rod.spacing for rod in records], dtype=float),
        moduli=np.array([rod.moduli for rod in records], dtype=float).T.copy(),
    )
