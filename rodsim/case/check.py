"""Checks across sections: what no single key can get wrong.

Each check yields findings (path, reason). They run on whatever sections validated, so that all
problems of a file are reported at once; sections that did not are None.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator

import numpy as np

from rodsim.case.expressions import Expression
from rodsim.case.fields import BYTES_PER_POINT, MOST_POINTS
from rodsim.case.model import Case, Rod, Spacings, Time, Tube
from rodsim.case.words import did_you_mean
from rodsim.case.yaml_text import Path
from rodsim.registry import kinds

Finding = tuple[Path, str]
MOST_FRAMES = 10_000_000
MOST_SAMPLES, SOME = 10_000, 200  # segments looked at
ALONG_THE_RUN = np.arange(1, 200) / 200.0
WHOLE = 1e-9  # relative; how near a multiple of the step must be
NO_REST_STATE = 2.0
COARSE = 1.0
ABSURD = 1000.0  # times as many points
THIN = 1.0 - 1e-9  # spacings in an epsilon: there the error is 0.3 %, docs/choosing.md


def check(case: Case, rod_names: Iterable[str]) -> tuple[list[Finding], list[Finding]]:
    """Return (errors, warnings) of a case, some sections of which may be None.

    ``rod_names`` are all rods of the file, also those that did not validate.
    """
    rod_names = list(rod_names)
    errors = [*_rods(case), *_tracers(case, rod_names)]
    for kind in kinds():
        errors += kind.check(case, rod_names) if kind.check else ()
    warnings: list[Finding] = [*_thin(case)]
    for kind in kinds():
        warnings += kind.doubt(case) if kind.doubt else ()
    if case.time is not None:
        errors += _step_missing(case.time)
        warnings += _ignored(case.time)
        if case.output is not None:
            errors += _frames(case)
    for name, rod in (case.rods or {}).items():
        known = rod.shape.ds is not None and not rod.needs_data
        if not known or (case.parameters is None and _has_expression(rod)):
            continue
        end = case.time.end if case.time else 0.0
        found = check_strain_twist(rod.entries, rod.shape.ds, rod.shape.segments, end)
        errors += [(("rods", name, *path), reason) for path, reason in found[0]]
        warnings += [(("rods", name, *path), reason) for path, reason in found[1]]
    return errors, warnings


def check_strain_twist(
    entries: tuple, ds: float, segments: int, end: float
) -> tuple[list[Finding], list[Finding]]:
    """Return (errors, warnings) of a rod's strain twist; paths start below the rod.

    ``entries``: three numbers or functions of s and t, with ``uses_t``.

    Taken at the segments' midpoints s = (k + 1/2) ds, at t = 0 and t = end, and of a drive at some
    of them at times between: every entry must be finite there, and abs(Omega) ds <= 2. A discrete
    strain is 2 sin(theta/2)/ds, theta the angle between neighbouring triads, so no rest state has
    more.
    """
    warnings: list[Finding] = []
    driven = any(callable(entry) and entry.uses_t for entry in entries)
    for s, times in _samples(driven, ds, segments, end):
        omega = [_entry(entry, s, times) for entry in entries]
        for i, values in enumerate(omega):
            if not np.all(np.isfinite(values)):
                at = _where(s, times, np.argmin(np.isfinite(values)))
                return [(("strain_twist", i), f"is not finite at {at}")], []
        with np.errstate(all="ignore"):
            angle = np.sqrt(sum(values**2 for values in omega)) * ds
        largest, at = float(np.max(angle)), _where(s, times, np.argmax(angle))
        found = f"abs(Omega) ds = {largest:.4g} at {at}"
        if not largest <= NO_REST_STATE:
            advice = "no rest state (the discrete strain is 2 sin(theta/2)/ds): "
            advice += _finer("use a smaller ds", largest, "strain_twist")
            return [(("strain_twist",), f"{found}: above {NO_REST_STATE:g} there is {advice}")], []
        if largest > COARSE and not warnings:
            warnings = [(("strain_twist",), f"{found}: the rod is coarse: use a smaller ds")]
    return [], warnings


def _samples(driven: bool, ds: float, segments: int, end: float) -> Iterator[tuple]:
    """Yield (s, times) at which the strain twist is looked at."""
    every, some = (
        (np.floor(np.linspace(0, segments - 1, min(segments, most))) + 0.5) * ds
        for most in (MOST_SAMPLES, SOME)
    )
    yield every, np.zeros(1)
    if driven:
        yield every, np.array([end])
        yield some, end * ALONG_THE_RUN


def _where(s, times, index):
    t, k = np.divmod(index, len(s))
    return f"s = {s[k]:.4g}, t = {times[t]:.4g}"


def _entry(entry: float | Callable, s: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Return the values (T, S) of an entry."""
    if callable(entry):
        return entry(s, times[:, None])
    return np.full((len(times), len(s)), entry)


def _has_expression(rod: Rod) -> bool:
    return any(isinstance(entry, Expression) for entry in rod.entries)


def _step_missing(time: Time) -> Iterator[Finding]:
    if not time.method.adaptive and time.step is None:
        yield ("time", "step"), f"missing: {time.integrator} needs the length of its steps"


def _ignored(time: Time) -> Iterator[Finding]:
    """What another method would use: changing ``integrator`` alone must be enough to compare."""
    if time.method.adaptive and time.step is not None:
        yield ("time", "step"), f"ignored: {time.integrator} chooses its steps by the tolerance"
    if not time.method.adaptive and "tolerance" in time.model_fields_set:
        yield ("time", "tolerance"), f"ignored: {time.integrator} has a fixed step"
    if not time.method.adaptive and time.max_step is not None:
        yield ("time", "max_step"), f"ignored: {time.integrator} has a fixed step"


def _frames(case: Case) -> Iterator[Finding]:
    """Frames are not too many, and fall on steps of fixed length."""
    time, interval = case.time, case.interval
    key = ("output", "interval")
    if time.end / interval > MOST_FRAMES:
        yield key, f"would write {time.end / interval:.3g} frames: at most {MOST_FRAMES}"
    if time.method.adaptive or time.step is None:
        return
    yield from _multiple(("time", "end"), time.end, time)
    if interval < time.end:  # else only t = 0 and t = end are frames
        yield from _multiple(key, interval, time)


def _multiple(path: Path, value: float, time: Time) -> Iterator[Finding]:
    steps = value / time.step
    if math.isfinite(steps) and round(steps) and abs(steps - round(steps)) <= WHOLE * steps:
        return
    reason = f"must be a whole multiple of time.step = {time.step:g} for {time.integrator}"
    near = f": try {round(steps) * time.step:.9g}" if math.isfinite(steps) and round(steps) else ""
    yield path, reason + near


def spacings_differ(spacings: dict[str, float]) -> str | None:
    """Return why epsilon cannot be given in spacings of these rods, or None when it can."""
    if not spacings or max(spacings.values()) <= min(spacings.values()) * (1.0 + WHOLE):
        return None
    each = ", ".join(f"{name} {ds:.6g}" for name, ds in spacings.items())
    return f"the rods' spacings differ ({each}): give epsilon as a length"


def _rods(case: Case) -> Iterator[Finding]:
    rods = case.rods or {}
    if case.fluid is not None and isinstance(case.fluid.epsilon, Spacings):
        known = {name: rod.shape.ds for name, rod in rods.items() if rod.shape.ds is not None}
        if reason := spacings_differ(known):
            yield ("fluid", "epsilon"), reason
    if case.plane is not None:
        for name, rod in rods.items():
            for i in (1, 2) if rod.strain_twist != "natural" else ():
                if rod.entries[i] != 0.0:
                    reason = f"Omega_{i + 1} must be the number 0 where plane is {case.plane}"
                    yield ("rods", name, "strain_twist", i), reason


def _thin(case: Case) -> Iterator[Finding]:
    """The blobs of neighbouring points overlap."""
    if case.fluid is None:
        return
    epsilon = case.fluid.epsilon
    for name, rod in (case.rods or {}).items():
        if (ds := rod.shape.ds) is None:
            continue
        if reason := thin(epsilon, name, ds):
            yield ("fluid", "epsilon"), reason
            return


def thin(epsilon: float | Spacings, name: str, ds: float) -> str | None:
    """Return that fluid flows between the points of a rod, or None where it does not."""
    share = epsilon.spacings if isinstance(epsilon, Spacings) else epsilon / ds
    if share >= THIN:
        return None
    reason = f"is {share:.3g} spacings of rod '{name}': fluid flows between its points"
    advice = _finer("use more points, 2 spacings in an epsilon", 2.0 / share, "epsilon")
    return f"{reason}; {advice}"


def _finer(advice: str, times: float, what: str) -> str:
    """Return the advice to use more points, unless nobody would want so many times as many."""
    if times < ABSURD:
        return advice
    return f"{times:.2g} times as many points would do: are the units of {what} and the rod right?"


def _tracers(case: Case, rod_names: list[str]) -> Iterator[Finding]:
    for name, group in (case.tracers or {}).items():
        markers = group.around * group.along if isinstance(group, Tube) else len(group)
        if markers > MOST_POINTS:
            gigabytes = markers * BYTES_PER_POINT / 1e9
            yield ("tracers", name), f"{markers:.3g} markers would need about {gigabytes:.3g} GB"
        if isinstance(group, Tube) and rod_names and group.rod not in rod_names:
            hint = did_you_mean(group.rod, rod_names) or f": the rods are {', '.join(rod_names)}"
            yield ("tracers", name, "rod"), f"no such rod{hint}"
