"""What ``rodsim info`` says of bodies, held ends, motors and hooks."""

from __future__ import annotations

import math

import numpy as np

from rodsim.blocks.ends import held_ends
from rodsim.units import unit_text

DRAG, TURNING = (1, 0, -1), (1, 2, -1)


def describe_held(case, scene) -> list[str]:
    """Return two lines for each body and one for each held end."""
    lines = []
    for body in scene.bodies:
        lines += _of_body(case, body)
    return lines + [_of_end(name, which, end, case.units) for name, which, end in held_ends(case)]


def _of_body(case, body):
    units, resistance = case.units, body.resistance
    lines = [
        f"body {body.name}: {body.shape.kind}, {body.surface.points.shape[1]} points, epsilon "
        f"{body.surface.epsilon:.4g} {units.length}, {_motion(case.bodies[body.name].motion)}"
    ]
    exact = exact_resistance(body.shape, case.fluid.viscosity)
    for name, place, dimension in (("drag", 0, DRAG), ("torque", 3, TURNING)):
        unit = unit_text(dimension, units.names)
        if exact is None:
            block = resistance[place : place + 3, place : place + 3]
            values = ", ".join(f"{value:.4g}" for value in np.diag(block))
            lines.append(f"body {body.name}: {name} along its x, y, z {values} {unit}")
            continue
        across = 0.5 * (resistance[place, place] + resistance[place + 1, place + 1])
        found = resistance[place + 2, place + 2], across
        told = (
            f"{way} its axis {value:.4g} ({100.0 * (value / true - 1.0):+.2f} % of the exact)"
            for way, value, true in zip(("along", "across"), found, exact[name], strict=True)
        )
        lines.append(f"body {body.name}: {name} {', '.join(told)} {unit}")
    return lines


def _motion(motion):
    return motion if isinstance(motion, str) else "moved as given"


def exact_resistance(shape, viscosity: float) -> dict[str, tuple[float, float]] | None:
    """Return drag and torque along and across the axis, None where there is no formula.

    Sphere: 6 pi mu a, 8 pi mu a^3. Spheroid: that of its half length a times factors of Kim &
    Karrila (1991), table 3.3 (long) and 3.4 (flat), by the eccentricity.
    """
    if shape.kind not in ("sphere", "spheroid"):
        return None
    pole = shape.radius if shape.kind == "sphere" else 0.5 * shape.length
    drag, torque = spheroid_factors(pole / shape.radius)
    largest = max(pole, shape.radius)
    return {
        "drag": tuple(6.0 * math.pi * viscosity * largest * x for x in drag),
        "torque": tuple(8.0 * math.pi * viscosity * largest**3 * x for x in torque),
    }


def spheroid_factors(aspect: float):
    """Return the factors of drag and torque, (along, across) each; aspect: pole over equator."""
    slender = min(aspect, 1.0 / aspect)
    e = math.sqrt(1.0 - slender * slender)
    if e < 1e-3:  # the axes differ by less than 1e-6, and the formulas are 0/0 there
        return (1.0, 1.0), (1.0, 1.0)
    if aspect > 1.0:
        big = math.log((1.0 + e) / (1.0 - e))
        p, q = 2.0 * e - (1.0 - e * e) * big, -2.0 * e + (1.0 + e * e) * big
        drag = 8.0 / 3.0 * e**3 / q, 16.0 / 3.0 * e**3 / (2.0 * e + (3.0 * e * e - 1.0) * big)
        torque = 4.0 / 3.0 * e**3 * (1.0 - e * e) / p, 4.0 / 3.0 * e**3 * (2.0 - e * e) / q
        return drag, torque
    s, angle = slender, math.asin(e)
    drag = (
        4.0 / 3.0 * e**3 / ((2.0 * e * e - 1.0) * angle + e * s),
        8.0 / 3.0 * e**3 / ((2.0 * e * e + 1.0) * angle - e * s),
    )
    torque = (
        2.0 / 3.0 * e**3 / (angle - e * s),
        2.0 / 3.0 * e**3 * (2.0 - e * e) / (e * s - (1.0 - 2.0 * e * e) * angle),
    )
    return drag, torque


def _of_end(name, which, end, units):
    """Return the line of a held end: how, by what, and what turns it."""
    to = "space" if end.to == "space" else f"body {end.to}"
    parts = [f"{end.hold} to {to}"]
    if end.move is not None:
        parts.append("moved as given")
    if (motor := end.motor) is not None:
        drive = "rate" if motor.rate is not None else "torque"
        value = motor.rate if motor.rate is not None else motor.torque
        unit = unit_text((0, 0, -1) if drive == "rate" else (1, 2, -2), units.names)
        text = "as given" if callable(value) else f"{value:.4g}"
        line = "" if motor.free_rate is None else f", none left at {motor.free_rate:.4g}"
        parts.append(f"motor with {drive} {text} {unit}{line}")
    if (hook := end.hook) is not None:
        unit = unit_text((1, 2, -2), units.names)
        twisting = hook.twisting if hook.twisting == "stiff" else f"{hook.twisting:.4g}"
        parts.append(f"hook bending {hook.bending:.4g}, twisting {twisting} {unit}")
    return f"{which} of rod {name}: {', '.join(parts)}"
