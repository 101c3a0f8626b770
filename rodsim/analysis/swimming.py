"""How fast something swims."""

import numpy as np

from rodsim.errors import UsageError


def swimming_velocity(
    time: np.ndarray, position: np.ndarray, period: float, skip: int = 1
) -> np.ndarray:
    """Return the mean velocity (3,) of the centroid of ``position`` (T, N, 3), length/time.

    Least squares of a straight line through the centroid, over the whole periods that follow the
    first ``skip``, so that the oscillation within a period averages out. Raises UsageError if the
    run has no whole period after those, or fewer than three frames in them.
    """
    begin = skip * period
    whole = np.floor((time[-1] - begin) / period * (1.0 + 1e-9))
    if whole < 1:
        raise UsageError(f"the run ends at {time[-1]:g}: needs {skip + 1} periods of {period:g}")
    chosen = (time >= begin * (1.0 - 1e-9)) & (time <= (begin + whole * period) * (1.0 + 1e-9))
    if chosen.sum() < 3:
        raise UsageError("needs three frames or more in whole periods: a shorter output.interval")
    return np.polyfit(time[chosen], position[chosen].mean(axis=1), 1)[0]
