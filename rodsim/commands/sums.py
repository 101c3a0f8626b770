"""What the sums of a scene cost, exact and fast, for ``rodsim info``."""

from __future__ import annotations

from time import perf_counter

import numpy as np

LEAST = 1000  # points from which on fast sums are spoken of unasked; fewer have little to gain
SHARE = 0.1  # of the tolerance: the accuracy that would do
OVERHEAD = 2.7  # a pair of the fast sum, over one of the exact: short lists, the ways up and down
AT_WALL = 1.5  # the same where pairs have images and last longer
MEGABYTE = 1e6


def describe_sums(case, scene) -> list[str]:
    """Return a line on the cost of an evaluation by exact and by fast sums; none for few points.

    The exact one is timed at some of the points and scaled; of the fast one the pairs are counted.
    """
    asked, points = case.fluid.sums, scene.rods.points
    if asked is None and points < LEAST:
        return []
    from rodsim.compiled.threads import threads_for
    from rodsim.flows.fast.plan import rod_sum

    time = case.time
    accuracy = SHARE * time.tolerance if time.method.adaptive else SHARE * 1e-4
    accuracy = asked.accuracy if asked else max(accuracy, 1e-12)
    about = scene.rods.count, accuracy, scene.epsilon, scene.viscosity, scene.blob, scene.planar
    about += (scene.wall,)
    with threads_for(points**2):
        position = scene.initial.position
        fast = rod_sum(position, *about)
        tables = fast.count(position)
        seconds = _seconds_a_pair(fast, position)
    more = OVERHEAD if scene.wall is None else AT_WALL
    exact, quick = seconds * points**2, seconds * more * fast.pairs
    pays = float(f"{more * fast.pairs / points:.1g}")
    kind = "fast" if asked else "exact"
    return [
        f"sums: {kind}; an evaluation takes about {exact:.2g} s by exact sums ({points**2:.2g} "
        f"pairs), {quick:.2g} s by fast ones of accuracy {accuracy:g} ({fast.pairs:.2g} pairs, "
        f"{tables.nbytes / MEGABYTE:.2g} MB of lists), which pay from about {pays:g} points on"
    ]


def _seconds_a_pair(fast, position):
    """Time the exact sum at some points."""
    some, loads = fast.sampled(position), np.ones((6, position.shape[1]))
    spent = []
    for _ in range(3):
        begin = perf_counter()
        fast.exact(some, position, loads, *fast.fluid, np.zeros((6, some.shape[1])))
        spent.append(perf_counter() - begin)
    return min(spent) / (some.shape[1] * position.shape[1])
