"""The steps of a run that are still to come, seen from its first ones.

Fixed steps are counted. Those of an adaptive method are not known ahead, but they have a course:
short motions die first, what is left is ever slower, and a step grows as the 0.8th power of the
time, until a drive or ``max_step`` holds it. The power, and how far a drive goes in a step, are
measured: on the shipped scenes, and on variants of them at tolerances from 1e-3 to 1e-8
(docs/choosing.md).
"""

from __future__ import annotations

import math

from rodsim.integrators.rkc import MOST_STAGES, MOST_TRAVEL, RATE_SAFETY, REFRESH, stages_for

GROWTH = 0.8
TRAVEL = 3.0  # tolerance^(-1/3): a local error of order 3
LAST = 3  # steps whose sizes are averaged
ESTIMATE = 5.0  # evaluations of an estimate of the fastest rate, in the mean

Steps = list[tuple[float, float]]  # (size, how many)


def steps_ahead(system, integrator, made: list[tuple[float, float]], end: float) -> Steps:
    """Return the steps up to ``end``, after those ``made``: (time of its end, size) each."""
    time = made[-1][0]
    if not integrator.method.adaptive:
        return [(integrator.size, round((end - time) / integrator.size))]
    recent = made[-LAST:]
    start, size = (
        math.exp(math.fsum(map(math.log, x)) / len(x)) for x in zip(*recent, strict=True)
    )
    most = _longest(system, integrator, time, size)
    steps = []
    while (left := end - time) > 0.0:
        size_now = size * (time / start) ** GROWTH
        if size_now >= most < left:
            return [*steps, (most, left / most)]
        steps.append((min(size_now, left), 1))
        time += steps[-1][0] if size_now < left else left
    return steps


def _longest(system, integrator, time, size):
    """Return where steps stop growing: at ``max_step``, by a drive, by the number of stages.

    They are not shorter than those that were made.
    """
    most = min(integrator.max_size, (MOST_STAGES**2 - 1.0) / (1.54 * integrator.fastest_rate))
    far = system.scene.parts.travel(time, size)
    share = min(MOST_TRAVEL, TRAVEL * integrator.tolerance ** (1.0 / 3.0))
    return min(most, size * max(1.0, share / far)) if far > 0.0 else most


def evaluations_of(steps: Steps, method, rate: float) -> float:
    """Return the evaluations of steps of a method where the fastest rate is ``rate``."""
    if not method.adaptive:
        return method.stages * math.fsum(count for _, count in steps)
    each = ESTIMATE / REFRESH
    return math.fsum(n * (stages_for(size, RATE_SAFETY * rate) + each) for size, n in steps)
