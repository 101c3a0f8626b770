"""The fastest rate of a scene: the spectral radius of its Jacobian, by Arnoldi iteration."""

import numpy as np

from rodsim.dynamics import RodSystem
from rodsim.integrators.passes import image, probe
from rodsim.rods.state import State

PERTURBATION = 1e-6  # rad, and of the longest rod


class SpectralRadius:
    """Arnoldi iteration in the scaled norm (positions relative to the longest rod).

    The Jacobian is never formed: J v is (f(y + d v) - f(y))/d. Its largest eigenvalues lie close
    together, where power iteration can stand still at one of them, up to 9 % below the largest.
    Arnoldi's Ritz values pass it by after some ten products more. The eigenvector is kept, so that
    a refresh takes a few evaluations; it starts with a part in every mode all the same.
    """

    TOLERANCE = 0.01
    FIRST_TOLERANCE = 0.001
    FEWEST = 4
    FEWEST_AT_FIRST = 12
    MOST = 60
    LARGEST_BASIS = 4_000_000  # numbers

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
        first = self.vector is None
        fewest = self.FEWEST_AT_FIRST if first else self.FEWEST
        if tolerance is None:
            tolerance = self.FIRST_TOLERANCE if first else self.TOLERANCE
        vector, rho, made, close = self._start(), 0.0, 0, 0
        room = max(self.FEWEST + 2, min(self.MOST, self.LARGEST_BASIS // self.system.rod_size))
        while made < self.MOST:
            for found in self._krylov(state, rate, vector, room):
                before, (rho, vector) = rho, found
                made += 1
                close = close + 1 if abs(rho - before) <= tolerance * rho else 0
                if (close > made / 3 and made >= fewest) or not (np.isfinite(rho) and rho > 0.0):
                    made = self.MOST
                    break
        self.vector = vector if np.isfinite(rho) and rho > 0.0 else None
        return rho

    def _krylov(self, state, rate, start, room):
        """Yield the largest Ritz value and its vector after each of up to ``room`` products."""
        basis = np.empty((room, start.size))
        upper = np.zeros((room, room))
        basis[0] = start / np.linalg.norm(start)
        for k in range(room):
            product = self._times(state, rate, basis[k])
            if not np.isfinite(product).all():
                yield np.nan, start
                return
            for _ in range(2):  # once more for what rounding leaves
                along = basis[: k + 1] @ product
                product -= along @ basis[: k + 1]
                upper[: k + 1, k] += along
            values, vectors = np.linalg.eig(upper[: k + 1, : k + 1])
            largest = int(np.abs(values).argmax())
            yield float(np.abs(values[largest])), vectors[:, largest].real @ basis[: k + 1]
            rest = float(np.linalg.norm(product))
            if k + 1 == room or rest <= 1e-9 * np.abs(values[largest]):
                return
            upper[k + 1, k] = rest
            basis[k + 1] = product / rest

    def _times(self, state, rate, vector):
        """Return J v in the scaled norm."""
        system = self.system
        weights, product = system.weights[: system.rod_size], np.empty_like(vector)
        y, shifted = system.zeros(), system.zeros()
        probe(PERTURBATION, vector, weights, y)
        system.rate(state.time, state, y, shifted)
        image(PERTURBATION, shifted, rate, weights, product)
        return product

    def _start(self):
        """Return the kept vector with a part in every mode, always the same: runs must repeat."""
        noise = np.random.default_rng(20130101).standard_normal(self.system.rod_size)
        noise /= np.linalg.norm(noise)
        return noise if self.vector is None else self.vector + 0.1 * noise
