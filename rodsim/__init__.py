"""Elastic rods in viscous fluid: Kirchhoff rods driven by regularized Stokeslets, rotlets, dipoles.

>>> import rodsim
>>> case = rodsim.load_case("configs/closed_ring.yaml", overrides=["time.end=0.01"])
>>> rodsim.simulate(case, "out.h5")
>>> with rodsim.open_trajectory("out.h5") as run:
...     print(run.time[-1], run.position[-1].shape)

Method: Olson, Lim & Cortez, J. Comput. Phys. 238 (2013) 169-187.
Importing this package changes nobody's Numba settings, and is cheap: each name below loads what
it needs on first use.
"""

from importlib import import_module

__version__ = "0.1.0"

_HOMES = {
    "load_case": "rodsim.case",
    "simulate": "rodsim.run.simulate",
    "resume": "rodsim.run.simulate",
    "open_trajectory": "rodsim.output",
    "velocity": "rodsim.flows.velocity",
    "pressure": "rodsim.flows.velocity",
    "RodsimError": "rodsim.errors",
}
__all__ = ["__version__", *_HOMES]


def __getattr__(name):
    if name not in _HOMES:
        raise AttributeError(f"module 'rodsim' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__():
    return sorted(__all__)
