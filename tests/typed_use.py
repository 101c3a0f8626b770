"""What a script that uses the library looks like to a type checker; CI checks it (see .ci/run)."""

from pathlib import Path
from typing import assert_type

import numpy as np

import rodsim

case = rodsim.load_case({"fluid": {"viscosity": 1e-3}}, overrides={"time.end": np.float64(0.01)})
assert_type(case, rodsim.Case)
assert_type(rodsim.load_case(Path("ring.yaml"), ["time.end=0.01"]), rodsim.Case)
assert_type(case.time.end, float)

summary = rodsim.simulate(case, Path("out.h5"), overwrite=True, until="still", progress=True)
assert_type(summary.frames, int)
assert_type(rodsim.resume("out.h5", overrides=["time.end=0.02"]).status, str)

with rodsim.open_trajectory("out.h5") as run:
    assert_type(run, rodsim.Trajectory)
    assert_type(run["tail"], rodsim.RodTrajectory)
    assert_type(run.position, np.ndarray)
    assert_type(run["tail"].measure("speed"), np.ndarray)
    assert_type(list(run), list[str])
    assert_type(run.frames, int)

assert_type(rodsim.analysis.writhe(run.position[-1], closed=False), float)

points, forces = [[0.0, 0.0, 0.5]], np.array([[0.0, 0.0, 2.0]])  # what NumPy can make an array of
linear, angular = rodsim.velocity(points, points, forces, np.zeros((1, 3)), 0.3, np.float64(1e-3))
assert_type(linear, np.ndarray)
assert_type(angular, np.ndarray | None)
assert_type(rodsim.pressure(points, points, forces, epsilon=0.3, wall=None), np.ndarray)
