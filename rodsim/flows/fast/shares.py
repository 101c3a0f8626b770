"""What each arc or group costs, and its work in shares of about equal cost."""

import numpy as np

SHARES = 256  # runs of about equal work, which threads share out


def sums_of(sizes, begins, partners):
    """Return the sum of the sizes of each one's partners."""
    ends = np.concatenate([[0.0], np.cumsum(sizes[partners], dtype=float)])
    return np.diff(ends[begins])


def cost_of(sizes, begins, partners):
    """Return how many pairs each one makes with its partners."""
    return sizes * sums_of(sizes, begins, partners)


def shared_out(which, chosen, cost):
    """Return the tables of what is to be done, in shares of about equal cost."""
    order = np.flatnonzero(chosen)
    count = min(SHARES, len(order))
    ends = np.cumsum(cost[order])
    inside = np.searchsorted(ends, ends[-1:] * np.arange(1, count) / count) if count else []
    return {which: order, which + 1: np.concatenate([[0], inside, [len(order)]])}
