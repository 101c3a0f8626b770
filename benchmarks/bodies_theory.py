"""Exact results for rigid bodies in a viscous fluid, which tests and the validation page share.

a : radius of a sphere, or half the length of a spheroid; mu : viscosity.
"""

import numpy as np


def spheroid_factors(half_length: float, radius: float) -> np.ndarray:
    """Return drag/(6 pi mu a) along and across, torque/(8 pi mu a^3) about and across the axis.

    Prolate, a = half_length > radius; Kim & Karrila 1991, table 3.4.
    """
    e = np.sqrt(1.0 - (radius / half_length) ** 2)
    L, e2, e3 = np.log((1.0 + e) / (1.0 - e)), e * e, e**3
    along = -2.0 * e + (1.0 + e2) * L
    return np.array([
        8.0 / 3.0 * e3 / along,
        16.0 / 3.0 * e3 / (2.0 * e + (3.0 * e2 - 1.0) * L),
        4.0 / 3.0 * e3 * (1.0 - e2) / (2.0 * e - (1.0 - e2) * L),
        4.0 / 3.0 * e3 * (2.0 - e2) / along,
    ])  # fmt: skip


def resistance_factors(shape) -> np.ndarray:
    """Return the same four of a sphere or a prolate spheroid of a case."""
    if shape.kind == "sphere":
        return np.ones(4)
    return spheroid_factors(0.5 * shape.length, shape.radius)


def measured_factors(resistance: np.ndarray, a: float, viscosity: float) -> np.ndarray:
    """Return the same four of a resistance matrix (6, 6), means over the two axes across."""
    drag = np.diag(resistance)[:3] / (6.0 * np.pi * viscosity * a)
    torque = np.diag(resistance)[3:] / (8.0 * np.pi * viscosity * a**3)
    return np.array([drag[2], drag[:2].mean(), torque[2], torque[:2].mean()])


STIMSON_JEFFERY = {2.05: 1.5431, 2.1: 1.5363, 2.5: 1.4861, 4.0: 1.3472}
"""U 6 pi mu a/F of two equal spheres along their line, by the distance of centres over a."""


def stimson_jeffery(distance: float, terms: int = 200) -> float:
    """Return U 6 pi mu a/F of two equal spheres along their line; distance of centres over a.

    Stimson & Jeffery 1926, eq. (37), cosh alpha = distance/2.
    """
    alpha, n = np.arccosh(0.5 * distance), np.arange(1, terms + 1)
    n = n[n * alpha < 300.0]
    top = 4.0 * np.sinh((n + 0.5) * alpha) ** 2 - ((2 * n + 1) * np.sinh(alpha)) ** 2
    bottom = 2.0 * np.sinh((2 * n + 1) * alpha) + (2 * n + 1) * np.sinh(2.0 * alpha)
    weights = n * (n + 1) / ((2 * n - 1) * (2 * n + 3))
    drag = 4.0 / 3.0 * np.sinh(alpha) * np.sum(weights * (1.0 - top / bottom))
    return 1.0 / drag


def brenner(height: float, terms: int = 200) -> float:
    """Return F/(6 pi mu a U) of a sphere that moves away from a wall; height of its centre over a.

    Brenner 1961, cosh alpha = height.
    """
    alpha, n = np.arccosh(height), np.arange(1, terms + 1)
    n = n[n * alpha < 300.0]
    top = 2.0 * np.sinh((2 * n + 1) * alpha) + (2 * n + 1) * np.sinh(2.0 * alpha)
    bottom = 4.0 * np.sinh((n + 0.5) * alpha) ** 2 - ((2 * n + 1) * np.sinh(alpha)) ** 2
    weights = n * (n + 1) / ((2 * n - 1) * (2 * n + 3))
    return 4.0 / 3.0 * np.sinh(alpha) * np.sum(weights * (top / bottom - 1.0))


def along_wall(height: float) -> float:
    """Return F/(6 pi mu a U) of a sphere that moves along a wall: Faxen's series, order (a/h)^5."""
    x = 1.0 / height
    return 1.0 / (1.0 - 9 / 16 * x + x**3 / 8 - 45 / 256 * x**4 - x**5 / 16)


def faxen(distance: float) -> tuple[float, float, float]:
    """Return U 8 pi mu/f along and across, Omega 8 pi mu/f of a free sphere beside a point force.

    Distance over a; Faxen's laws for the flow of a Stokeslet.
    """
    d = distance
    return 2.0 / d - 2.0 / (3.0 * d**3), 1.0 / d + 1.0 / (3.0 * d**3), 1.0 / d**2


def stokeslet(x, source, force, viscosity):
    """Return the velocity (3, n) at points (3, n) by a point force (3,) at a source (3,)."""
    r = x - np.asarray(source)[:, None]
    distance = np.linalg.norm(r, axis=0)
    force = np.asarray(force)
    return (force[:, None] + force @ r * r / distance**2) / distance / (8 * np.pi * viscosity)
