"""Scenes of the shipped configs, changed by ``--set`` strings, and runs of them in memory."""

from collections import deque
from pathlib import Path

import numpy as np

from rodsim.case import case_from_mapping, load_case
from rodsim.integrators.make import make_integrator
from rodsim.scene.build import build_scene
from rodsim.scene.system import RodSystem

ROOT = Path(__file__).parent.parent
CONFIGS = ROOT / "configs"
REFERENCE = Path(__file__).parent / "reference"


def load(config, *overrides):
    return load_case(CONFIGS / f"{config}.yaml", overrides)


def fixed(method, step):
    """Overrides that choose a fixed-step method."""
    return f"time.integrator={method}", f"time.step={step!r}"


def system_of(config, *overrides):
    case = load(config, *overrides)
    return case, RodSystem(build_scene(case))


def last(steps):
    """Return the last of many steps, keeping none of the others."""
    return deque(steps, maxlen=1).pop()


def final_state(config, *overrides):
    """Run a config to its end in memory; return (last state, system, integrator)."""
    case, system = system_of(config, *overrides)
    integrator = make_integrator(case.time, system)
    step = last(integrator.steps(system.scene.initial, case.time.end))
    return step.end, system, integrator


def reference(name):
    """Return position (3, M) and director (3, 3, M) of a stored reference solution."""
    table = np.loadtxt(REFERENCE / f"{name}.txt")
    return table[:, :3].T, table[:, 3:].reshape(-1, 3, 3).transpose(1, 2, 0)


def difference(state, other):
    """Largest difference of (positions, directors) of two states."""
    position = abs(state.position - other.position).max()
    return position, abs(state.director - other.director).max()


def system_from(data):
    """Return the case and the system of a case that is plain data."""
    case = case_from_mapping(data)
    return case, RodSystem(build_scene(case))


def end_of(data):
    """Run a case that is plain data to its end in memory; return (last state, system)."""
    case, system = system_from(data)
    steps = make_integrator(case.time, system).steps(system.scene.initial, case.time.end)
    return last(steps).end, system
