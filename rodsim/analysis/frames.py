"""Which stored frames are meant."""

import numpy as np

from rodsim.errors import UsageError


def nearest_frame(times: np.ndarray, asked: float, unit: str) -> int:
    """Return the number of the frame whose time is nearest to ``asked``.

    Raises UsageError for a time before the first or after the last one.
    """
    slack = 1e-9 * abs(times[-1])
    if not times[0] - slack <= asked <= times[-1] + slack:
        raise UsageError(
            f"t = {asked:g}: the file has frames from {times[0]:g} to {times[-1]:g} {unit}"
        )
    return int(np.argmin(np.abs(times - asked)))


def spread_frames(frames: int, wanted: int) -> list[int]:
    """Return ``wanted`` frame numbers at equal distances, the first and the last among them."""
    return sorted({round(n) for n in np.linspace(0, frames - 1, max(wanted, 1))})
