"""The forces of a scene at single states: loads, energy, and their derivatives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rodsim.compiled.parts import FORCE, PartList
from rodsim.compiled.rotations import displace
from rodsim.rest.carried import Carried
from rodsim.rest.stiffness import Differences, assembled
from rodsim.scene.evaluation import Evaluation
from rodsim.scene.state import Scene, State

UNEVEN = 1e-7  # of the largest stiffness
SMALL = 1e-5  # a motion, in rad and spacings: few pairs begin or cease to touch in it
ALIKE = 3e-7  # changes of the loads along it, of which differences leave 1e-8


def exact_parts(scene: Scene) -> PartList:
    """Return the forces of a scene with the exact gradients of their energies."""
    return PartList(
        part if part.statics.exact is None else replace(part, kernel=part.statics.exact)
        for part in forces_of(scene)
    )


def forces_of(scene: Scene) -> PartList:
    """Return the forces of a scene, with those of its constraints that have an energy."""
    added = [force for part in scene.parts for force in part.statics.adds]
    return PartList([*scene.parts.of(FORCE), *added])


class Forces:
    """The forces of a scene: those that runs have, or the exact gradients of their energies.

    ``free`` : the degrees of freedom, c N + k, that may change.
    """

    def __init__(self, scene: Scene, exact: bool = True):
        parts = exact_parts(scene) if exact else forces_of(scene)
        self.scene, self.exact, self.parts = scene, exact, parts
        self.free = free_numbers(scene)
        self.carried = Carried(scene, self.free)
        self._all = Evaluation(scene, parts)
        along = PartList(part for part in parts if part.statics.stiffness is None)
        self._differences = Differences(scene, along)
        self._coupling = [part for part in parts if part.statics.stiffness is not None]
        kept = {id(part) for part in parts if _energies(part, scene.initial, scene)}
        self._storing = [part for part in parts if id(part) in kept]
        others = PartList(p for p in parts if id(p) not in kept and not p.potential)
        self._working = Evaluation(scene, others) if others else None

    def conservative_at(self, state: State) -> bool:
        """Tell whether the loads are a gradient there, and K all of its derivative.

        K is not symmetric where loads turn with a rod. A force that couples nodes and does not say
        so shows in the loads along a motion of all nodes, of which K then gives another change.
        """
        matrix = self.stiffness(state)
        uneven = abs(matrix - matrix.T).max()
        if uneven > UNEVEN * abs(matrix).max():
            return False
        change = np.random.default_rng(1).normal(size=(6, self.scene.nodes))
        change[:3] *= SMALL * self.scene.rods.spacing.min()
        change[3:] *= SMALL
        change.flat[np.setdiff1d(np.arange(change.size), self.free)] = 0.0
        ends = (self.loads(self.moved(state, side * change)).ravel() for side in (0.5, -0.5))
        found, expected = np.subtract(*ends)[self.free], -(matrix @ change.ravel()[self.free])
        return bool(abs(found - expected).max() <= ALIKE * abs(expected).max())

    def loads(self, state: State) -> np.ndarray:
        """Return g and m of all nodes, (6, N); what bodies hold acts on them too."""
        return self.carried.passed_on(_evaluated(self._all, state), state)

    def moved(self, state: State, change: np.ndarray) -> State:
        """Return a state after a change (6, N), with held ends where their bodies are."""
        return self.carried.placed(moved(state, change))

    def energy(self, state: State) -> float:
        """Return the sum of the energies that forces store."""
        found = (_energies(part, state, self.scene) for part in self._storing)
        return float(sum(np.sum(value) for values in found for value in values.values()))

    def work(self, before: State, after: State, change: np.ndarray) -> float:
        """Return the work of forces that store no energy, along a change (6, N) of the state.

        That is the change times the mean of the loads at both ends: exact for dead loads.
        """
        if self._working is None:
            return 0.0
        loads = _evaluated(self._working, before) + _evaluated(self._working, after)
        return 0.5 * float((loads * self.carried.whole(change, before, after)).sum())

    def stiffness(self, state: State):
        """Return K = -d(loads)/dz of the free degrees of freedom, a sparse matrix."""
        blocks = [self._differences(state)]
        blocks += [p.statics.stiffness(state, p.row, self.scene) for p in self._coupling]
        matrix = assembled(blocks, self.scene.nodes)
        after = lambda change: self.loads(self.moved(state, change))  # noqa: E731
        return self.carried.coupled(matrix, state, after)


def free_numbers(scene: Scene) -> np.ndarray:
    """Return the degrees of freedom c N + k that nothing holds: in a plane only y, z, theta_x."""
    free = np.ones((6, scene.nodes), dtype=bool)
    if scene.planar:
        free[[0, 4, 5]] = False
    free = free.ravel()
    for part in scene.parts:
        free[list(part.statics.holds)] = False
    return np.flatnonzero(free)


def stored_energies(scene: Scene, state: State) -> dict[str, float]:
    """Return the energies that the forces of a scene store, summed over rods, by name."""
    found = {}
    for part in forces_of(scene):
        for name, value in _energies(part, state, scene).items():
            found[name.removesuffix("_energy")] = float(np.sum(value))
    return found


def moved(state: State, change: np.ndarray) -> State:
    """Return a state after a change (6, N): of positions, and rotation vectors of triads."""
    tracer = state.tracer
    out = np.empty_like(state.position), np.empty_like(state.director), np.empty_like(tracer)
    displace(state.geometry, np.concatenate([change.ravel(), np.zeros(tracer.size)]), out)
    return State(state.time, out[0], out[1], tracer, state.work)


def _evaluated(evaluation, state):
    loads = np.zeros((6, state.position.shape[1]))
    evaluation.add(state, loads, np.zeros_like(loads), np.zeros_like(state.tracer))
    return loads


def _energies(part, state, scene):
    """Return the energies that a part stores, by name."""
    found = part.observe(state, part.row, scene) if part.observe else {}
    return {name: value for name, value in found.items() if name.endswith("_energy")}
