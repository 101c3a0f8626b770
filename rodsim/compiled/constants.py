"""Numbers that compiled code and its callers share, without importing Numba."""

HALF_TURN = 4e-14  # 1 + tr A of neighbouring triads below this has lost every digit
