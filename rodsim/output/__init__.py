"""The output file: HDF5, written as the run goes, readable meanwhile, with a view for ParaView."""

from rodsim.output.layout import CaseText, Plan
from rodsim.output.reader import Trajectory, open_trajectory
from rodsim.output.writer import TrajectoryWriter

__all__ = ["CaseText", "Plan", "Trajectory", "TrajectoryWriter", "open_trajectory"]
