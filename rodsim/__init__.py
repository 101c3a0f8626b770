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
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rodsim import analysis as analysis
    from rodsim import plotting as plotting
    from rodsim.analysis.trajectory import RodTrajectory as RodTrajectory
    from rodsim.analysis.trajectory import Trajectory as Trajectory
    from rodsim.analysis.trajectory import open_trajectory as open_trajectory
    from rodsim.case import Case as Case
    from rodsim.case import load_case as load_case
    from rodsim.errors import RodsimError as RodsimError
    from rodsim.flows.velocity import pressure as pressure
    from rodsim.flows.velocity import velocity as velocity
    from rodsim.run.simulate import resume as resume
    from rodsim.run.simulate import simulate as simulate

__version__ = "0.1.0"

_HOMES = {
    "Case": "rodsim.case",
    "load_case": "rodsim.case",
    "simulate": "rodsim.run.simulate",
    "resume": "rodsim.run.simulate",
    "open_trajectory": "rodsim.analysis.trajectory",
    "Trajectory": "rodsim.analysis.trajectory",
    "RodTrajectory": "rodsim.analysis.trajectory",
    "velocity": "rodsim.flows.velocity",
    "pressure": "rodsim.flows.velocity",
    "RodsimError": "rodsim.errors",
}
_ROOMS = ("analysis", "plotting")  # of functions for arrays and pictures
__all__ = ["__version__", *_HOMES, *_ROOMS]


def __getattr__(name: str):
    if name in _ROOMS:
        return import_module(f"rodsim.{name}")
    if name not in _HOMES:
        raise AttributeError(f"module 'rodsim' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__():
    return sorted(__all__)
