"""The methods in time, as data: one entry each, which all that ask about a method read."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Method:
    """What is known of a method without running it.

    order : of its error. option : the word in ``time`` that sets its accuracy. stages :
    evaluations in a step, None where it chooses them. limit : largest stable step times the fastest
    rate, on the negative real axis; None where stages are added as needed. home : its class,
    ``module:name``. about : one line.
    """

    name: str
    order: int
    option: str
    stages: int | None
    limit: float | None
    home: str
    about: str

    @property
    def adaptive(self) -> bool:
        """Whether it chooses its steps: then ``option`` is a tolerance."""
        return self.option == "tolerance"


METHODS = {
    method.name: method
    for method in (
        Method(
            "rkc", 3, "tolerance", None, None, "rodsim.integrators.rkc:RKC",
            "Runge-Kutta-Chebyshev, corrected by its own defect; adaptive",
        ),
        Method(
            "rk4", 4, "step", 4, 2.785293563405282, "rodsim.integrators.rk4:RK4",
            "classical Runge-Kutta; |1 + z + z^2/2 + z^3/6 + z^4/24| = 1 at z = -limit",
        ),
        Method(
            "euler", 1, "step", 1, 2.0, "rodsim.integrators.euler:Euler",
            "forward Euler, the paper's method",
        ),
    )
}  # fmt: skip
FIXED_STEP = {name: method for name, method in METHODS.items() if not method.adaptive}
ADAPTIVE = {name: method for name, method in METHODS.items() if method.adaptive}
