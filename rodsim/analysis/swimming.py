"""How fast something swims, and at what cost."""

import numpy as np

from rodsim.errors import UsageError


def velocity(time: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Return the velocity (T, 3) of the centroid of ``position`` (T, N, 3), length/time.

    By differences of its places at the frames on both sides, at the ends those of the first and
    last three: an error of second order in the interval. NaN for a single frame.
    """
    return rate(time, position.mean(axis=1))


def speed(time: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Return the speed (T,) of the centroid of ``position`` (T, N, 3), see :func:`velocity`."""
    return np.linalg.norm(velocity(time, position), axis=1)


def rate(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the derivative over time (T,) of ``values`` (T, ...), of second order."""
    if len(time) < 2:
        return np.full(np.shape(values), np.nan)
    return np.gradient(values, time, axis=0, edge_order=min(2, len(time) - 1))


def mean_rate(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the slope of the straight line through ``values`` (T, 3), by least squares."""
    return np.polyfit(time, values, 1)[0] if len(time) > 1 else np.full(3, np.nan)


def towing_drag(length: float, radius: float, viscosity: float) -> float:
    """Return the force over speed that tows a straight cylinder along its axis.

    2 pi mu L (e (1 + 0.307 e)/(1 - 0.5 e) + 0.426 e^3) with e = 1/ln(L/radius), an error of order
    e^4 (Batchelor, J. Fluid Mech. 44 (1970) 419-440). A rod of blobs has round ends beyond its
    last points: its drag is larger by 3 to 7 % at L/radius of 160 to 25. NaN if it is not slender.
    """
    if length <= np.e * radius:
        return np.nan
    e = 1.0 / np.log(length / radius)
    return 2.0 * np.pi * viscosity * length * (e * (1 + 0.307 * e) / (1 - 0.5 * e) + 0.426 * e**3)


def efficiency(speed, power, length: float, radius: float, viscosity: float):
    """Return the efficiency of a swimmer, drag * speed^2 / power, a pure number (Lighthill 1975).

    ``speed`` and ``power`` : means over a period, or arrays; power is that of the rod on the
    fluid. The drag is that of the straightened rod, :func:`towing_drag`; ``radius`` is that of the
    cylinder which moves the fluid as the rod does, epsilon exp(-1/2) for algebraic7.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return towing_drag(length, radius, viscosity) * np.square(speed) / power


def whole_periods(time: np.ndarray, period: float, skip: int = 1) -> np.ndarray:
    """Return which frames at ``time`` (T,) lie in the whole periods after the first ``skip``.

    Raises UsageError if the run has no whole period after those, or fewer than three frames in
    them.
    """
    begin = skip * period
    whole = np.floor((time[-1] - begin) / period * (1.0 + 1e-9))
    if whole < 1:
        raise UsageError(f"the run ends at {time[-1]:g}: needs {skip + 1} periods of {period:g}")
    chosen = (time >= begin * (1.0 - 1e-9)) & (time <= (begin + whole * period) * (1.0 + 1e-9))
    if chosen.sum() < 3:
        raise UsageError("needs three frames or more in whole periods: a shorter output.interval")
    return chosen


def swimming_velocity(
    time: np.ndarray, position: np.ndarray, period: float, skip: int = 1
) -> np.ndarray:
    """Return the mean velocity (3,) of the centroid of ``position`` (T, N, 3), length/time.

    Least squares of a straight line through the centroid, over the whole periods that follow the
    first ``skip``, so that the oscillation within a period averages out. Raises UsageError as
    :func:`whole_periods` does.
    """
    chosen = whole_periods(time, period, skip)
    return mean_rate(time[chosen], position[chosen].mean(axis=1))
