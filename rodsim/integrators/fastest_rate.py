"""The fastest rate of a scene: the spectral radius of its Jacobian, by Arnoldi iteration."""

import math

import numpy as np

from rodsim.scene.state import State
from rodsim.scene.system import RodSystem

PERTURBATION = 1e-6  # rad, and of the length of a rod


class FastestRate:
    """Arnoldi iteration in the scaled norm (positions relative to the length of their rod).

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
        self.vector = self._noise = None

    def memory(self) -> dict:
        """Return what later estimates depend on, for a checkpoint; no vector yet is zeros."""
        return {"vector": np.zeros(self.system.rod_size) if self.vector is None else self.vector}

    def recall(self, memory: dict) -> None:
        """Take over what ``memory`` returned."""
        self.vector = memory["vector"] if memory["vector"].any() else None

    def estimate(
        self, state: State, rate: np.ndarray | None = None, tolerance: float | None = None
    ) -> float:
        """Return rho (1/time) at ``state``; NaN if it is not finite.

        ``rate`` : dy/dt there, where it is known; else it is evaluated.
        Iterates until a third more products change the estimate by less than ``tolerance``
        (relative; by default 0.1 % at first, then 1 %).
        """
        if rate is None:
            zeros = self.system.zeros
            rate = self.system.velocities(state.time, state, zeros(), zeros())
        first = self.vector is None
        fewest = self.FEWEST_AT_FIRST if first else self.FEWEST
        if tolerance is None:
            tolerance = self.FIRST_TOLERANCE if first else self.TOLERANCE
        most = max(self.FEWEST + 2, min(self.MOST, self.LARGEST_BASIS // self.system.rod_size))
        space, rho, check = _Krylov(self._start(), most), 0.0, 3 * fewest // 4
        product = np.empty(self.system.rod_size)
        for made in range(1, self.MOST + 1):
            self.system.product(state, rate, space.newest, PERTURBATION, product)
            space.extend(product)
            last = space.closed or made == self.MOST
            if not (last or space.full or made == check):
                continue
            check = made + max(1, made // 3)
            before, rho = rho, space.largest()
            if not (math.isfinite(rho) and rho > 0.0):
                self.vector = None
                return rho
            if last or (made >= fewest and abs(rho - before) <= tolerance * rho):
                break
            if space.full:
                space = _Krylov(space.vector(), most)
        self.vector = space.vector()
        return rho

    def _start(self):
        """Return the kept vector with a part in every mode, always the same: runs must repeat."""
        if self._noise is None:
            noise = np.random.default_rng(20130101).standard_normal(self.system.rod_size)
            self._noise = noise / np.linalg.norm(noise)
        return self._noise if self.vector is None else self.vector + 0.1 * self._noise


class _Krylov:
    """An orthonormal basis of v, J v, J J v, ..., and J in it: an upper Hessenberg matrix."""

    def __init__(self, start, most):
        self.basis = np.empty((most, start.size))
        self.matrix = np.zeros((most, most))
        self.basis[0] = start / np.linalg.norm(start)
        self.made, self.closed, self.finite = 0, False, True

    @property
    def newest(self):
        """The vector whose product with J is wanted."""
        return self.basis[self.made]

    @property
    def full(self):
        """Whether the basis has all of its vectors."""
        return self.made == len(self.basis)

    def extend(self, product):
        """Take J times the newest vector, and change it; closed if that leads nowhere new."""
        self.made += 1
        whole = math.sqrt(product @ product)
        if not math.isfinite(whole):
            self.finite, self.closed = False, True
            return
        rest = self._without_known(product)
        if rest < 0.5 * whole:  # once more, for what rounding leaves of much that was taken away
            rest = self._without_known(product)
        self.closed = not rest > 1e-9 * whole
        if not (self.full or self.closed):
            self.matrix[self.made, self.made - 1] = rest
            self.basis[self.made] = product / rest

    def _without_known(self, product):
        """Take from the product what the basis has of it; return the norm of the rest."""
        known = self.basis[: self.made]
        along = known @ product
        product -= along @ known
        self.matrix[: self.made, self.made - 1] += along
        return math.sqrt(product @ product)

    def largest(self):
        """Return the largest of the Ritz values, by size; NaN if the matrix is not finite."""
        if not self.finite:
            return math.nan
        values, vectors = np.linalg.eig(self.matrix[: self.made, : self.made])
        sizes = np.abs(values)
        at = sizes.argmax()
        self._of_largest = vectors[:, at].real
        return float(sizes[at])

    def vector(self):
        """Return the Ritz vector of the value that ``largest`` has just found, its real part."""
        return self._of_largest @ self.basis[: self.made]
