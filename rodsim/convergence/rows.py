"""Which runs a study makes: each is the case with some keys changed."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rodsim.blocks.surface import FEWEST, MOST
from rodsim.case.methods import FIXED_STEP

AXES = ("tolerance", "step", "points", "body_points", "epsilon", "accuracy")
ACCURACIES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)  # of fast sums
EXACT = 0.0
TOLERANCES = tuple(10.0 ** (k / 2) for k in range(4, -5, -1))  # times the case's own
REFERENCE, CHECK = 1e-4, 1e-3  # of the case's tolerance
TIGHTEST = 1e-12
STEPS = 6.0  # in which the time gone grows by e, at a tolerance of 1e-4
UNEVEN = 0.8
ESTIMATES = 45.0  # evaluations, of the fastest rate before the first step
SPACE_TOLERANCE = 1e-6  # in a study of space no error in time is to be seen
PARTS = 20  # of a run: many steps lead to the end of the first of them, too (``stretch``)
MANY = 50 * PARTS  # steps: there it makes a step smaller by at most 2 per cent
STABLE = 0.9  # of the limit of stability: the longest step of a fixed-step method
ROWS = {"euler": 2, "rk4": 1}  # the longest step and its half; RK4 has no error to be seen there
BODY_LEVELS = (0.5, 1.0, 2.0, 4.0)  # of the case's own points of bodies
SENSITIVITY = (0.5, 2**-0.5, 2**0.5, 2.0)  # epsilon over the case's own


@dataclass(frozen=True)
class Row:
    """One run: which axis and method it belongs to, the value there, the keys that make it so.

    ``evaluations``: a guess of what it costs, for the progress bar. ``part``: of the run that is
    made (``stretch``).
    """

    axis: str
    method: str
    value: float
    overrides: tuple[str, ...]
    evaluations: float
    part: float = 1.0


def quiet(case) -> tuple[str, ...]:
    """Return what every run changes: no frames but the end."""
    longest = case.max_step_size
    kept = (f"time.max_step={longest!r}",) if math.isfinite(longest) else ()
    return f"output.interval={case.time.end!r}", *kept


def rkc(tolerance: float) -> tuple[str, ...]:
    """Return the keys that choose the adaptive method."""
    return "time.integrator=rkc", "time.step=null", f"time.tolerance={tolerance!r}"


def guess(case, rate: float, tolerance: float) -> float:
    """Guess the evaluations of rkc, mostly to a factor of 2.

    What comes to rest takes steps that grow with the time gone: as many as ln(1 + T rho), of fewer
    stages than even ones. What is driven, some for each that the drive makes anyway. Their number
    is that of the shipped scenes.
    """
    # Here, since the command asks for AXES before Numba has its settings.
    from rodsim.integrators.rkc import FEWEST_STAGES, RATE_SAFETY, stages_for

    end, drive = case.time.end, case.time.end / case.max_step_size
    steps = max(STEPS * math.log1p(end * rate), drive) * (1e-4 / tolerance) ** 0.25
    steps = max(steps, drive, 1.0)
    stages = stages_for(end / steps, RATE_SAFETY * rate) * (1.0 if drive else UNEVEN)
    return ESTIMATES + steps * max(FEWEST_STAGES, stages)


def tolerance_rows(case, rate) -> list[Row]:
    """Tolerances two decades around the case's own, half a decade apart."""
    values = [float(f"{case.time.tolerance * factor:.0e}") for factor in TOLERANCES]
    return [
        Row("tolerance", "rkc", value, rkc(value), guess(case, rate, value))
        for value in values
        if TIGHTEST < value < 1.0
    ]


def step_rows(case, limits) -> list[Row]:
    """For each method of fixed step the longest stable step, for Euler also its half."""
    rows = []
    for name, method in sorted(FIXED_STEP.items()):
        count = _steps(case.time.end, STABLE * limits.largest_steps[name])
        if count > MANY:
            count += -count % PARTS
        for halving in range(ROWS[name]):
            step = case.time.end / (count * 2**halving)
            overrides = (
                f"time.integrator={name}",
                f"time.step={step!r}",
                "time.tolerance=null",
            )
            cost = method.stages * case.time.end / step
            rows.append(Row("step", name, step, overrides, cost))
    return rows


def _steps(end, longest):
    """Return a number of steps to the end, none longer than that; of 1, 2 or 5 times 10^n if
    such a step leads there.
    """
    power = 10.0 ** math.floor(math.log10(longest))
    for factor in (5, 2, 1):
        step = factor * power
        count = round(end / step)
        if step <= longest and count and abs(end / step - count) < 1e-9 * count:
            return count
    return math.ceil(end / longest)


def refine(case, factor: float) -> tuple[str, ...]:
    """Return the keys that multiply every rod's number of segments; length and epsilon stay."""
    keys = []
    for name, rod in case.rods.items():
        shape, closed = rod.shape, rod.shape.is_closed
        keys.append(f"rods.{name}.shape.points={round(shape.segments * factor) + (not closed)}")
        if getattr(shape, "spacing", None) is not None:
            keys.append(f"rods.{name}.shape.spacing={shape.spacing / factor!r}")
    return tuple(keys)


def space_levels(case) -> list[float]:
    """Return the factors on the segments: halves while they divide, the case's own, twice that;
    the last, twice the one before, is the reference.
    """
    segments = [rod.shape.segments for rod in case.rods.values()]
    coarse = [f for f in (4, 2) if all(s % f == 0 and s // f >= 3 for s in segments)]
    return [*(1.0 / f for f in coarse), 1.0, 2.0, 4.0]


def points_rows(case, rate, epsilon) -> list[Row]:
    """Numbers of points: intervals doubled at fixed length and epsilon; the last is the finest."""
    keys = (f"fluid.epsilon={epsilon!r}", *rkc(SPACE_TOLERANCE))
    total = sum(rod.shape.segments for rod in case.rods.values())
    return [
        Row(
            "points",
            "rkc",
            sum(round(rod.shape.segments * f) + (not rod.shape.is_closed)
                for rod in case.rods.values()),
            (*refine(case, f), *keys),
            guess(case, rate, SPACE_TOLERANCE),  # the fastest rate is that of epsilon
        )
        for f in space_levels(case)
        if total
    ]  # fmt: skip


def body_points(case) -> dict[str, int]:
    """Return the number of points of each body; those from a file have none of their own."""
    shapes = {name: body.shape for name, body in (case.bodies or {}).items()}
    return {name: shape.points for name, shape in shapes.items() if shape.kind != "file"}


def own_row(case, rate) -> Row:
    """The case itself, as studies of space run it."""
    cost = guess(case, rate, SPACE_TOLERANCE)
    return Row("own", "rkc", SPACE_TOLERANCE, rkc(SPACE_TOLERANCE), cost)


def body_rows(case, rate) -> list[Row]:
    """Numbers of points of the bodies, of all together; the last is the finest."""
    own, found = body_points(case), []
    for factor in BODY_LEVELS:
        numbers = {name: 2 * round(0.5 * factor * n) for name, n in own.items()}
        if min(numbers.values()) < FEWEST or max(numbers.values()) > MOST:
            continue
        keys = (f"bodies.{name}.shape.points={n}" for name, n in numbers.items())
        cost = guess(case, rate, SPACE_TOLERANCE) * factor**2
        value = sum(numbers.values())
        found.append(Row("body_points", "rkc", value, (*keys, *rkc(SPACE_TOLERANCE)), cost))
    return found


def epsilon_rows(case, rate, epsilon) -> list[Row]:
    """Other widths of the blob: another model, not a worse one."""
    return [
        Row(
            "epsilon",
            "rkc",
            factor * epsilon,
            (f"fluid.epsilon={factor * epsilon!r}", *rkc(SPACE_TOLERANCE)),
            guess(case, rate, SPACE_TOLERANCE) / factor,
        )
        for factor in SENSITIVITY
    ]


def accuracy_rows(case, rate) -> list[Row]:
    """Exact sums, and fast ones of several accuracies, at the case's own tolerance."""
    method, cost = case.time.integrator, guess(case, rate, case.time.tolerance)
    exact = Row("accuracy", method, EXACT, ("fluid.sums=null",), cost)
    fast = [Row("accuracy", method, a, (f"fluid.sums.accuracy={a!r}",), cost) for a in ACCURACIES]
    return [exact, *fast]
