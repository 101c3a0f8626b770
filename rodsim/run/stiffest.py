"""Which moduli set the fastest rate of a scene, and what less of them would give."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rodsim.integrators.fastest_rate import FastestRate
from rodsim.scene.moduli import with_moduli
from rodsim.scene.system import RodSystem

GROUPS = {("bending", "twisting"): ((0, 1), (2,)), ("shear", "stretch"): ((3, 4), (5,))}
PART = 0.25  # of the moduli, tried
COUNTS = 0.95  # of the fastest rate: a change that leaves more of it is none


@dataclass(frozen=True)
class Stiffest:
    """The moduli that set the fastest rate, by name, none where others do; the rate (1/time) with a
    quarter of them."""

    names: tuple[str, ...]
    rate: float


def stiffest(scene, rate: float) -> Stiffest:
    """Return what sets the fastest rate of a scene, which is ``rate``: up to four estimates more.

    Both moduli of a kind are tried, then each by itself: often two modes are equally fast.
    """
    tried = {names: _with_a_quarter(scene, sum(rows, ())) for names, rows in GROUPS.items()}
    names = min(tried, key=tried.get)
    lowest = tried[names]
    if lowest > COUNTS * rate:
        return Stiffest((), rate)
    for name, rows in zip(names, GROUPS[names], strict=True):
        alone = _with_a_quarter(scene, rows)
        if alone * COUNTS <= lowest:
            return Stiffest((name,), alone)
    return Stiffest(names, lowest)


def _with_a_quarter(scene, rows):
    factors = np.ones(6)
    factors[list(rows)] = PART
    changed = with_moduli(scene, factors)
    return FastestRate(RodSystem(changed)).estimate(changed.initial)
