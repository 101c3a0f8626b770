"""The fastest rate of a scene: the spectral radius of its Jacobian, by power iteration."""

import numpy as np

from rodsim.dynamics import RodSystem
from rodsim.integrators.passes import image, probe
from rodsim.rods.state import State


class SpectralRadius:
    """Nonlinear power iteration in the scaled norm (positions relative to the longest rod).

    The Jacobian is never formed: J v is (f(y + d v) - f(y))/d. The vector of the last estimate is
    kept, so that a refresh takes a few evaluations; from a fresh vector two early estimates can be
    alike by chance, so the first asks for more.
    """

    TOLERANCE = 0.01
    FIRST_TOLERANCE = 0.001
    FEWEST_AT_FIRST = 6
    MOST = 200

    def __init__(self, system: RodSystem):
        self.system = system
        self.vector = None

    def state(self) -> dict:
        """Return what later estimates depend on, for a checkpoint; no vector yet is zeros."""
        return {"vector": np.zeros(self.system.rod_size) if self.vector is None else self.vector}

    def restore(self, state: dict) -> None:
        """Take over what ``state`` returned."""
        self.vector = state["vector"] if state["vector"].any() else None

    def estimate(self, state: State, rate: np.ndarray, tolerance: float | None = None) -> float:
        """Return rho (1/time) at ``state``, where dy/dt is ``rate``; NaN if it is not finite.

        Iterates until two estimates differ by less than ``tolerance`` (relative; by default
        0.1 % at first, then 1 %).
        """
        system, n = self.system, self.system.rod_size
        fewest = self.FEWEST_AT_FIRST if self.vector is None else 1
        if tolerance is None:
            tolerance = self.FIRST_TOLERANCE if self.vector is None else self.TOLERANCE
        vector = self._start() if self.vector is None else self.vector.copy()
        weights, size, rho = system.weights[:n], 1e-6, 0.0
        y, shifted = system.zeros(), system.zeros()
        for iteration in range(self.MOST):
            probe(size, vector, weights, y)
            system.rate(state.time, state, y, shifted)
            before, rho = rho, image(size, shifted, rate, weights, vector)
            if not (np.isfinite(rho) and rho > 0.0):
                break
            if iteration >= fewest and abs(rho - before) <= tolerance * rho:
                break
        self.vector = vector if np.isfinite(rho) and rho > 0.0 else None
        return rho

    def _start(self):
        """Return a fixed vector with a part in every mode: runs must repeat bit for bit."""
        vector = np.random.default_rng(20130101).standard_normal(self.system.rod_size)
        return vector / np.linalg.norm(vector)
