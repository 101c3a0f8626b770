"""The classical Runge-Kutta method of order 4, on rotation vectors (Munthe-Kaas)."""

from rodsim.case.methods import METHODS
from rodsim.integrators.fixed import FixedStep


class RK4(FixedStep):
    """Four evaluations a step. Order 4; stable for h < 2.785/rho.

    The triads keep the order because the rate of the rotation vector carries its commutators
    (``rotations.rotation_vector_rate``).
    """

    method = METHODS["rk4"]

    def increment(self, state):
        """Return h/6 (k_1 + 2 k_2 + 2 k_3 + k_4)."""
        rate, h, t = self.system.rate, self.size, state.time
        k1 = rate(t, state, self.system.zeros(), self.system.zeros())
        k2 = rate(t + 0.5 * h, state, 0.5 * h * k1, self.system.zeros())
        k3 = rate(t + 0.5 * h, state, 0.5 * h * k2, self.system.zeros())
        k4 = rate(t + h, state, h * k3, self.system.zeros())
        return h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
