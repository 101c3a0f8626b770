"""The methods in time, by the name a case file gives them. Tests run over this registry."""

from rodsim.integrators.euler import Euler
from rodsim.integrators.rk4 import RK4
from rodsim.integrators.rkc import RKC
from rodsim.integrators.step import Integrator

METHODS = {"rkc": RKC, "rk4": RK4, "euler": Euler}
FIXED_STEP = {"rk4": RK4, "euler": Euler}


def make_integrator(time, system) -> Integrator:
    """Return the integrator of a case's ``time`` section for a system."""
    if time.integrator in FIXED_STEP:
        return FIXED_STEP[time.integrator](system, time.step)
    return METHODS[time.integrator](system, time.tolerance)
