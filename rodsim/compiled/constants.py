"""Numbers that compiled code and its callers share, without importing Numba."""

HALF_TURN = 4e-14  # 1 + tr A of neighbouring triads below this has lost every digit
ON_WALL = 1e-9  # of epsilon: what is less far below a wall is on it, but for rounding
CPU, GPU = DEVICES = ("cpu", "gpu")  # where sums are computed
