"""Forward Euler, the paper's method: eqs. (34), (35)."""

from rodsim.case.methods import METHODS
from rodsim.integrators.fixed import FixedStep


class Euler(FixedStep):
    """X_(n+1) = X_n + h u, D_(n+1) = exp(h w x) D_n. Order 1; stable for h < 2/rho."""

    method = METHODS["euler"]

    def increment(self, state):
        """Return h (u, w)."""
        rate = self.system.rate(state.time, state, self.system.zeros(), self.system.zeros())
        return self.size * rate
