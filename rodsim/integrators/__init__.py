"""The methods in time, by the name a case file gives them. Tests run over this registry."""

import math

from rodsim.integrators.euler import Euler
from rodsim.integrators.rk4 import RK4
from rodsim.integrators.rkc import RKC
from rodsim.integrators.step import Integrator

METHODS = {"rkc": RKC, "rk4": RK4, "euler": Euler}
FIXED_STEP = {"rk4": RK4, "euler": Euler}


def make_integrator(time, system, radius=None, longest=math.inf) -> Integrator:
    """Return the integrator of a case's ``time`` section for a system.

    ``radius``: the SpectralRadius that an adaptive method shall use, or None for one of its own;
    ``longest``: its longest step.
    """
    if time.integrator in FIXED_STEP:
        return FIXED_STEP[time.integrator](system, time.step)
    return METHODS[time.integrator](system, time.tolerance, radius, longest)
