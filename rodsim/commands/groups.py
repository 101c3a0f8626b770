"""Dimensionless groups of a scene, for ``rodsim info``: what compares it with another one."""

from __future__ import annotations

import math
from itertools import groupby

import numpy as np

from rodsim.case.expressions import Expression
from rodsim.case.materials import WIDTHS

SEGMENTS, TIMES = 200, 400  # at which a drive is looked at


def describe_rods(case, scene) -> list[str]:
    """Return a line for each rod, for the copies of one that is repeated a line together."""
    told = []
    for r, name in enumerate(scene.rods.names):
        kind = "closed" if scene.rods.closed[r] else "open"
        text = (
            f"{scene.rods.count[r]} points, {kind}, length {scene.rods.lengths[r]:.6g} "
            f"{case.units.length}, spacing {scene.rods.spacing[r]:.6g}"
        )
        origin = case.source.origins.get(name, "")
        copied = origin.startswith("number")
        of = f"{origin.partition(' of ')[2]}, repeated" if copied else origin
        own = "" if copied else _named(case.rods[name].parameters, "; ")
        told.append((name, f" ({of})" if of else "", f"{text}{own}"))
    return _together(told)


def describe_groups(case, scene) -> list[str]:
    """Return a line for each rod, for those that follow each other and have the same together."""
    return _together([(n, "", _groups(case, scene, r)) for r, n in enumerate(scene.rods.names)])


def describe_parameters(case) -> list[str]:
    """Return the parameters with their numbers, where there are any."""
    return [line] if (line := _named(case.parameters, "parameters: ")) else []


def _named(parameters, start: str) -> str:
    named = ", ".join(f"{name} = {value:.6g}" for name, value in parameters.items())
    return f"{start}{named}" if named else ""


def _together(told: list[tuple[str, str, str]]) -> list[str]:
    """Return lines of (rod, what it is, text); equal ones in a row become one line."""
    lines = []
    for (of, text), rows in groupby(told, key=lambda row: row[1:]):
        names = [name for name, _, _ in rows]
        several = f"rods {names[0]} to {names[-1]}" if len(names) > 1 else f"rod {names[0]}"
        lines.append(f"{several}{of}: {text}")
    return lines


def _groups(case, scene, r: int) -> str:
    length, spacing = float(scene.rods.lengths[r]), float(scene.rods.spacing[r])
    radius = scene.epsilon / WIDTHS[scene.blob]
    drag = 4.0 * math.pi * scene.viscosity / (math.log(length / radius) + 0.5)
    bending = float(scene.rods.moduli[:2, r].min())
    parts = [f"epsilon/ds {scene.epsilon / spacing:.4g}", f"length/radius {length / radius:.4g}"]
    if drag <= 0.0:  # as thick as long: not slender
        return ", ".join(parts)
    parts.append(f"elasto-viscous time {drag * length**4 / bending:.4g} {case.units.time}")
    entries = case.rods[scene.rods.names[r]].entries
    if frequency := drive_frequency(entries, length, case.time.end):
        parts.append(f"drive {frequency:.4g} rad/{case.units.time}")
        parts.append(f"sperm number {length * (drag * frequency / bending) ** 0.25:.4g}")
    return ", ".join(parts)


def drive_frequency(entries, length: float, end: float) -> float:
    """Return the angular frequency of what is driven: rms of dOmega/dt over rms of Omega.

    Omega is taken about its mean in time at each place; a wave sin(k s + omega t) gives omega. 0 if
    nothing is driven, or where a value is not finite.
    """
    driven = [e for e in entries if isinstance(e, Expression) and e.uses_t]
    s = (np.arange(SEGMENTS) + 0.5) * length / SEGMENTS
    t = ((np.arange(TIMES) + 0.5) * end / TIMES)[:, None]
    change = spread = 0.0
    for entry in driven:
        values = entry(s, t)
        with np.errstate(all="ignore"):
            change += float(np.mean(entry.derivative("t")(s, t) ** 2))
            spread += float(np.mean((values - values.mean(axis=0)) ** 2))
    good = 0.0 < spread < math.inf and 0.0 < change < math.inf
    return math.sqrt(change / spread) if good else 0.0
