"""The fastest rate of a scene: the spectral radius of its Jacobian, by power iteration."""

import numpy as np

from rodsim.dynamics import RodSystem
from rodsim.rods.state import State


class SpectralRadius:
    """Nonlinear power iteration in the scaled norm (positions relative to the longest rod).

    The Jacobian is never formed: J v is (f(y + d v) - f(y))/d. The vector of the last estimate is
    kept, so that a refresh takes a few evaluations.
    """

    TOLERANCE = 0.01
    MOST = 200

    def __init__(self, system: RodSystem):
        self.system = system
        self.vector = None

    def estimate(self, state: State, rate: np.ndarray, tolerance: float | None = None) -> float:
        """Return rho (1/time) at ``state``, where dy/dt is ``rate``; NaN if it is not finite.

        Iterates until two estimates differ by less than ``tolerance`` (relative, default 1 %).
        """
        system, n = self.system, self.system.rod_size
        tolerance = self.TOLERANCE if tolerance is None else tolerance
        scale = 1.0 / system.weights
        vector = self._start() if self.vector is None else self.vector
        probe, shifted = system.zeros(), system.zeros()
        size, rho = 1e-6, 0.0
        for _ in range(self.MOST):
            probe[:n] = size * scale[:n] * vector
            system.rate(state.time, state, probe, shifted)
            image = (shifted[:n] - rate[:n]) * system.weights[:n] / size
            before, rho = rho, float(np.linalg.norm(image) / np.linalg.norm(vector))
            if not (np.isfinite(rho) and rho > 0.0):
                break
            vector = image / np.linalg.norm(image)
            if abs(rho - before) <= tolerance * rho:
                break
        self.vector = vector if np.isfinite(rho) else None
        return rho

    def _start(self):
        """Return a fixed vector with a part in every mode: runs must repeat bit for bit."""
        vector = np.random.default_rng(20130101).standard_normal(self.system.rod_size)
        return vector / np.linalg.norm(vector)
