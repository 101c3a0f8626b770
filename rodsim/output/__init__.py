"""The output file: HDF5, written as the run goes, readable meanwhile, with a view for ParaView.

Each name is loaded on first use: who needs only the layout does not wait for h5py.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rodsim.output.layout import CaseText as CaseText
    from rodsim.output.layout import Plan as Plan
    from rodsim.output.reader import Trajectory as Trajectory
    from rodsim.output.reader import open_trajectory as open_trajectory
    from rodsim.output.writer import TrajectoryWriter as TrajectoryWriter

_HOMES = {
    "CaseText": "layout",
    "Plan": "layout",
    "Trajectory": "reader",
    "TrajectoryWriter": "writer",
    "open_trajectory": "reader",
}
__all__ = list(_HOMES)


def __getattr__(name: str):
    if name not in _HOMES:
        raise AttributeError(f"module 'rodsim.output' has no attribute {name!r}")
    return getattr(import_module(f"rodsim.output.{_HOMES[name]}"), name)
