"""The leading error of RKC2, measured on the steps behind and taken out of the step ahead.

A step of RKC2 errs by -C h^3 y''', in linear and (from 4 stages on, to 2 %) nonlinear terms
alike; C is about 1/15, with 4 stages 1/11.7. The trapezoid of its end rates errs by h^3 y'''/12
the other way, so the two together tell y''' for nothing. A constant rate g = C h^2 y''' added to
every stage of the next step then cancels its error: order 3 at the price of order 2. It passes
through the stages as any rate does, so they damp what the stiff modes have put into it.

This is a deferred correction (Pereyra, Numer. Math. 8 (1966) 376-391) that lags by a step; RKC2
becomes a two-step method. On y' = lambda y its roots are below 1 all over the real stability
interval of RKC2, at all of the stage numbers (2 to 2000) and ratios of sizes (0.1 to 3) looked at.
Away from the real axis it gives up some of that: with an imaginary part of 5 % of the rate they
reach 1.1 to 1.4 where RKC2 alone stays below 1. Rates of rods are that far from real only while a
strongly disturbed rod relaxes, and the error control then rejects the step.
"""

import numpy as np

MEMORY = 0.5  # 0: unstable where steps grow by a quarter; 1: more errors of stiff modes, and lag
TREND = 0.3  # share of the change of y''' that is carried on; 0.5 can be unstable
MOST_GROWTH = 3.0
GROWN = 0.6  # tolerances that growth may add to the error of a step


def most_growth(uncorrected: float) -> float:
    """Return the ratio r of sizes by which a step may grow.

    ``uncorrected`` : C h^3 y''' of the step before, in tolerances. Corrected as much as that one
    (``Defect.correction``), the step errs by C h^3 y''' (r^3 - 1) more than one of the same size:
    at tight tolerances far more than what a corrected step leaves.
    """
    return min(MOST_GROWTH, (1.0 + GROWN / max(uncorrected, 1e-10)) ** (1.0 / 3.0))


class Defect:
    """Holds y''' of the last two accepted steps."""

    def __init__(self):
        self._behind = []  # (y''', size), the last step first

    def correction(self, size: float, c: float, nothing: np.ndarray) -> tuple:
        """Return (c, m, a, y'''_1, b, y'''_2): what corrects a step, and measures its error again.

        ``size``, ``c`` : of the step, its error constant. g = a y'''_1 + b y'''_2, of the steps
        behind; before any step ``nothing``, zeros, stands for them.

        g = C min(h, h_1)^3/h [y'''_1 + trend (y'''_1 - y'''_2)]: a step that grows is corrected
        as much as the step before it, or what is wrong in y''' would grow by (h/h_1)^3.

        The error that a step leaves of each number is C h^3 y''' - h g, and
        h^3 y''' = [h (f_0 + f_1)/2 - y + m h g]/(1/12 + m C), m = MEMORY, for the increment y
        with g in it; without g it is the same with m = 1, g = 0 (``passes.remaining``).
        """
        if not self._behind:
            return c, 1.0, 0.0, nothing, 0.0, nothing
        third, before = self._behind[0]
        factor = c * min(size, before) ** 3 / size
        if len(self._behind) == 1:
            return c, MEMORY, factor, third, 0.0, third
        oldest, earlier = self._behind[1]
        trend = TREND * (before + size) / (before + earlier) * min(1.0, earlier / before) ** 3
        return c, MEMORY, factor * (1.0 + trend), third, -factor * trend, oldest

    def accept(self, third: np.ndarray, size: float) -> None:
        """Keep y''' of a step that was accepted."""
        self._behind = [(third, size), *self._behind[:1]]

    def memory(self, numbers: int) -> dict:
        """Return the memory of the steps behind, for a checkpoint; no step has size 0."""
        behind = [*self._behind, *[(np.zeros(numbers), 0.0)] * 2][:2]
        return {
            "thirds": np.array([third for third, _ in behind]),
            "third_sizes": np.array([size for _, size in behind]),
        }

    def recall(self, memory: dict) -> None:
        """Take over what ``memory`` returned."""
        steps = zip(memory["thirds"], memory["third_sizes"].tolist(), strict=True)
        self._behind = [(third, size) for third, size in steps if size > 0.0]
