"""RKC: the stabilised explicit Runge-Kutta-Chebyshev method, corrected to order 3, adaptive.

Sommeijer, Shampine & Verwer, J. Comput. Appl. Math. 88 (1998) 315-326. Its stability interval on
the negative real axis grows as the square of the number of stages, 0.65 s^2, so the cost of
stiffness grows as its square root, without any linear algebra. Its leading error is taken out by
:mod:`rodsim.integrators.defect`, at no cost. Step sizes pass a digital filter (Soderlind, ACM
Trans. Math. Softw. 29 (2003) 1-26): the correction wants them to vary smoothly.
"""

import math
from functools import lru_cache

import numpy as np

from rodsim.case.methods import METHODS
from rodsim.errors import StepFailure
from rodsim.integrators.defect import Defect, most_growth
from rodsim.integrators.fastest_rate import FastestRate
from rodsim.integrators.step import Step
from rodsim.scene.state import State
from rodsim.scene.system import RodSystem, Trial

DAMPING = 2.0 / 13.0
SAFETY = 0.8
FILTER = 4.0  # b of the filter H211b: larger is smoother
GROWTH_AT_FIRST = 10.0
RATE_SAFETY = 1.1  # the estimate comes from below
MOST_SHARE = 0.9  # of what the parts let a step do: the next one is made for that
FEWEST_STAGES = 4  # with fewer, nonlinear terms have an error constant of their own
MOST_TRAVEL = 1.0  # of the strain twist in a step: 1.4 rad of a wave
REFRESH = 25  # accepted steps between estimates of the fastest rate
MOST_STAGES = 2000  # rounding grows as s^2 and is then still below 1e-9 of the increment


def stages_for(size: float, rho: float) -> int:
    """Return the number of stages that makes a step of ``size`` stable at rate ``rho``."""
    return max(FEWEST_STAGES, 1 + int(math.sqrt(1.54 * size * rho + 1.0)))


def _shrunk(error: float, share: float) -> float:
    """Return the factor on the size of a step that erred, or took more than its share."""
    if not (math.isfinite(error) and math.isfinite(share)):
        return 0.1
    by_error = SAFETY * error**-0.25 if error > 1.0 else 1.0
    return max(0.1, min(by_error, MOST_SHARE / share if share > 1.0 else 1.0))


@lru_cache(maxsize=256)
def coefficients(s: int):
    """Return the (s + 1, 5) table of mu, nu, mu~, gamma~, c of the s-stage method.

    With T_j the Chebyshev polynomials at w_0 = 1 + damping/s^2: b_j = T_j''/(T_j')^2,
    w_1 = T_s'/T_s'', a_j = 1 - b_j T_j; rows 0 and 1 hold only mu~_1 and c_1.
    """
    w0 = 1.0 + DAMPING / s**2
    t, t1, t2 = [1.0, w0], [0.0, 1.0], [0.0, 0.0]  # lists: NumPy would take three times as long
    for _ in range(2, s + 1):
        t.append(2.0 * w0 * t[-1] - t[-2])
        t1.append(2.0 * w0 * t1[-1] - t1[-2] + 2.0 * t[-2])
        t2.append(2.0 * w0 * t2[-1] - t2[-2] + 4.0 * t1[-2])
    w1 = t1[s] / t2[s]
    b = [second / (first * first) for first, second in zip(t1[2:], t2[2:], strict=True)]
    b = [b[0], b[0], *b]
    a = [1.0 - bj * tj for bj, tj in zip(b, t, strict=True)]
    rows = [[0.0] * 5, [0.0, 0.0, b[1] * w1, 0.0, 0.0]]
    for j in range(2, s + 1):
        mu_tilde = 2.0 * b[j] * w1 / b[j - 1]
        c = w1 * t2[j] / t1[j]
        mu, nu = 2.0 * b[j] * w0 / b[j - 1], -b[j] / b[j - 2]
        rows.append([mu, nu, mu_tilde, -a[j - 1] * mu_tilde, c])
    rows[1][4] = rows[2][4] / t1[2]
    rows[s][4] = 1.0
    return np.array(rows)


@lru_cache(maxsize=256)
def error_constant(s: int) -> float:
    """Return C(s) of the local error -C h^3 y''': 1/6 less the coefficient of h^3 f' f' f."""
    rows = coefficients(s).tolist()
    before, here = (0.0, 0.0, 0.0), (rows[1][2], 0.0, 0.0)  # of h f, h^2 f'f, h^3 f'f'f
    for mu, nu, mu_tilde, gamma_tilde, _ in rows[2:]:
        first = mu * here[0] + nu * before[0] + mu_tilde + gamma_tilde
        second = mu * here[1] + nu * before[1] + mu_tilde * here[0]
        third = mu * here[2] + nu * before[2] + mu_tilde * here[1]
        before, here = here, (first, second, third)
    return 1.0 / 6.0 - here[2]


class RKC:
    """Adaptive RKC. ``tolerance`` bounds the local error of a step, in ``RodSystem.norm``.
    ``max_size`` : no step is longer than this.
    """

    method = METHODS["rkc"]

    def __init__(
        self,
        system: RodSystem,
        tolerance: float,
        fastest: FastestRate | None = None,
        max_size: float = math.inf,
    ):
        self.system = system
        self.tolerance = tolerance
        self.max_size = max_size
        self.accepted = self.rejected = self.max_stages = 0
        self.fastest_rate = math.nan
        self._fastest = fastest or FastestRate(system)
        self._driven = system.scene.parts.driven
        self._size = None
        self._rate = None  # velocities at the end of the last step
        self._previous = None  # (step size, error) of the last accepted and corrected step
        self._defect, self._nothing = Defect(), system.zeros()

    def steps(self, state: State, end: float):
        """Yield accepted steps of adapted size until ``end`` is reached exactly."""
        system, f0 = self.system, self._rate
        while state.time < end:
            f0 = system.at_start(state, f0)
            if self.accepted % REFRESH == 0:
                self._estimate_rate(state, f0)
            if self._size is None:
                self._size = self._first_size(state, f0, end)
            size, trial = self._accepted(state, f0, end)
            self._defect.accept(trial.third, size)
            self.accepted += 1
            self._rate = trial.velocities
            time = end if size == end - state.time else state.time + size
            after, rates = system.state_after(state, time, trial), (f0, trial.rates)
            yield Step(system, self.accepted, state, size, trial.increment, after, rates)
            state, f0 = after, trial.velocities

    def memory(self) -> dict:
        """Return all memory and the counters, for a checkpoint; what is not there yet is NaN."""
        numbers, nothing = self.system.size, math.nan
        return {
            "accepted": self.accepted,
            "rejected": self.rejected,
            "max_stages": self.max_stages,
            "spectral_radius": self.fastest_rate,
            "size": nothing if self._size is None else self._size,
            "previous": np.array(self._previous or (nothing, nothing)),
            "rate": np.full(numbers, nothing) if self._rate is None else self._rate,
            **self._fastest.memory(),
            **self._defect.memory(numbers),
        }

    def recall(self, memory: dict) -> None:
        """Take over what ``memory`` returned."""
        for name in ("accepted", "rejected", "max_stages"):
            setattr(self, name, memory[name])
        self.fastest_rate = memory["spectral_radius"]
        self._size = None if math.isnan(memory["size"]) else memory["size"]
        previous = memory["previous"].tolist()
        self._previous = None if math.isnan(previous[0]) else tuple(previous)
        self._rate = None if np.isnan(memory["rate"]).any() else memory["rate"]
        self._fastest.recall(memory)
        self._defect.recall(memory)

    def attempt(self, state: State, f0: np.ndarray, size: float) -> Trial:
        """Try a step of ``size``. Its error is in ``RodSystem.norm``, not in tolerances."""
        s = stages_for(size, self.fastest_rate)
        self.max_stages = max(self.max_stages, s)
        correction = self._defect.correction(size, error_constant(s), self._nothing)
        return self.system.take_step(state, size, coefficients(s), f0, correction)

    def _accepted(self, state, f0, end):
        """Try sizes until one is accepted; return it with its trial."""
        while True:
            size = self._followed(state, self._limited(end - state.time), end)
            trial = self.attempt(state, f0, size)
            error, share = trial.error / self.tolerance, self.system.guarded(trial.increment)
            if error <= 1.0 and share <= 1.0:
                self._grow(size, error, trial.third)
                self._size = min(self._size, size * MOST_SHARE / max(share, 1e-10))
                return size, trial
            self.rejected += 1
            self._previous = None
            self._size = size * _shrunk(error, share)
            if not self._size > 1e-13 * end:
                raise StepFailure(f"no step is accepted, down to a size of {self._size:.2g}", state)
            self._estimate_rate(state, f0)

    def _grow(self, size, error, third):
        """Choose the next size by the filter H211b from the last two sizes and errors.

        The first step is not corrected and errs more than those that follow it, so the second may
        be far longer. The step after a rejection does not grow: growth itself leaves an error,
        what the correction does not follow, and a step grown at once is often rejected again.
        """
        error = max(error, 1e-10)
        factor = SAFETY * error**-0.25
        if self._previous is None and self.accepted > 1:
            factor = min(1.0, factor)
        elif self._previous is not None:
            before_size, before = self._previous
            both = (SAFETY**8 / (error * before)) ** (0.25 / FILTER)
            factor = both * (size / before_size) ** (-1.0 / FILTER)
        if factor > 1.0:
            factor = min(factor, self._most_growth(size, third))
        self._previous = (size, error) if self.accepted else None
        self._size = size * max(0.1, factor)

    def _most_growth(self, size, third):
        if not self.accepted:
            return GROWTH_AT_FIRST
        c = error_constant(stages_for(size, self.fastest_rate))
        return most_growth(c * size**3 * self._norm(third) / self.tolerance)

    def _norm(self, vector):
        """Return a norm over all rods at once: a guess of that over each."""
        n, w = self.system.rod_size, self.system.weights
        return np.sqrt(np.mean(np.square(vector[:n] * w[:n])))

    def _limited(self, left):
        """Return the size to try: never a sliver before the end, never too many stages."""
        size = min(self._size, self.max_size, (MOST_STAGES**2 - 1.0) / (1.54 * self.fastest_rate))
        if size >= 0.9 * left and left <= self.max_size:
            return left
        return min(size, 0.5 * left)

    def _followed(self, state, size, end):
        """Return a size at which a step still follows the drive, whatever the tolerance allows.

        A step over whole periods of a wave would see the same rate at both ends and find no error.
        """
        if not self._driven:
            return size
        travel = self.system.scene.parts.travel
        while (far := travel(state.time, size)) > MOST_TRAVEL:
            size *= max(0.1, 0.9 * MOST_TRAVEL / far)
            if not size > 1e-13 * end:
                raise StepFailure("a drive changes faster than steps can follow", state)
        return size

    def _estimate_rate(self, state, f0):
        rho = self._fastest.estimate(state, f0)
        if not math.isfinite(rho):
            raise StepFailure("the rates of change are not finite", state)
        self.fastest_rate = max(RATE_SAFETY * rho, 1e-300)

    def _first_size(self, state, f0, end):
        """Return a first step from the change of the rate over a step of 1/rho."""
        trial = min(1.0 / self.fastest_rate, end)
        f1 = self.system.rate(state.time + trial, state, trial * f0, self.system.zeros())
        change = trial * self._norm(f1 - f0) / self.tolerance
        if not math.isfinite(change):  # as where even the trial comes to a wall
            return 0.1 * trial
        return min(end, 0.1 * trial / math.sqrt(change) if change > 0.0 else end)
