"""The integrator that a case asks for."""

import math
from importlib import import_module

from rodsim.case.methods import METHODS
from rodsim.integrators.step import Integrator


def make_integrator(time, system, fastest=None, max_size=math.inf) -> Integrator:
    """Return the integrator of a case's ``time`` section for a system.

    ``fastest``: the FastestRate that an adaptive method shall use, or None for one of its own;
    ``max_size``: its longest step.
    """
    method = METHODS[time.integrator]
    module, _, name = method.home.partition(":")
    make = getattr(import_module(module), name)
    if method.adaptive:
        return make(system, time.tolerance, fastest, max_size)
    return make(system, time.step)
