"""A small rod that things act on, as plain data; ``changed`` makes other scenes of it."""

import numpy as np
from extremes import changed

from rodsim.compiled.parts import PartList
from rodsim.scene.evaluation import Evaluation

__all__ = ["ROD", "changed", "of_part", "weighted_mean"]

ROD = {
    "fluid": {"viscosity": 1.3, "epsilon": 0.31},
    "rods": {
        "rod": {
            "shape": {
                "kind": "straight",
                "points": 12,
                "spacing": 0.13,
                "rotate": {"axis": [0.3, 1.1, 0.2], "degrees": 50},
                "origin": [0.2, -0.3, 0.4],
            },
            "moduli": {
                "bending": [0.36, 0.42], "twisting": 0.29, "shear": [21.0, 19.0], "stretch": 17.0,
            },
            "strain_twist": [0.9, 0.25, 0.7],
        }
    },
    "time": {"end": 0.6, "tolerance": 1e-9},
}  # fmt: skip


def of_part(system, name, state=None, loads=None):
    """Return what one part adds to the loads (6, N) and to the velocities (6, N) of a state."""
    scene = system.scene
    state = scene.initial if state is None else state
    parts = PartList(part for part in scene.parts if part.name == name and part.side != "tracers")
    loads = np.zeros((6, scene.rods.points)) if loads is None else loads.copy()
    velocities = np.zeros_like(loads)
    Evaluation(scene, parts).add(state, loads, velocities, np.zeros((3, 0)))
    return loads, velocities


def weighted_mean(system, values):
    """Return the mean (3,) over a rod of values (3, N), half at the ends: the trapezoidal rule."""
    weights = np.ones(values.shape[1])
    weights[[0, -1]] = 0.5
    return values @ weights / weights.sum()
