"""Motions of all points and triads at once, and the rate of their rotation vectors.

theta (3, N) is a rotation vector: axis times angle, in the laboratory frame. A step of any
integrator is an increment (X - X_n, theta); the triads at its end are exp(theta x) D_n.
"""

import math

import numpy as np

from rodsim.compiled.flags import STATE, VEC, inline, kernel, unsigned
from rodsim.vectors import cross

SERIES_UP_TO = 1.0  # squared angle: there the next terms of the series are below 1e-19


@inline
def _series(angle2):
    """Return sin(a)/a and (1 - cos(a))/a^2 from a^2 <= 1, by their power series."""
    a = b = 1.0
    for n in (20, 18, 16, 14, 12, 10, 8, 6, 4, 2):  # unrolled: the quotients are constants
        a = 1.0 - angle2 * (1.0 / (n * (n + 1.0))) * a
        b = 1.0 - angle2 * (1.0 / ((n + 1.0) * (n + 2.0))) * b
    return a, 0.5 * b


@inline
def _closed_form(angle2):
    """Return sin(a)/a and (1 - cos(a))/a^2 from a^2 > 0."""
    angle = math.sqrt(angle2)
    half = math.sin(0.5 * angle) / angle
    return math.sin(angle) / angle, 2.0 * half * half


@inline
def _turn(a, b, tx, ty, tz, D, k, out):
    for i in range(3):
        dx, dy, dz = D[i, 0, k], D[i, 1, k], D[i, 2, k]
        cx, cy, cz = ty * dz - tz * dy, tz * dx - tx * dz, tx * dy - ty * dx
        out[i, 0, k] = dx + a * cx + b * (ty * cz - tz * cy)
        out[i, 1, k] = dy + a * cy + b * (tz * cx - tx * cz)
        out[i, 2, k] = dz + a * cz + b * (tx * cy - ty * cx)


@inline
def _add(position, shift, out):
    for c in range(3):
        for k in range(np.uint64(position.shape[1])):
            out[c, k] = position[c, k] + shift[c, k]


@unsigned
def rotate(theta, D, out):
    """out = exp(theta x) D: Rodrigues' formula (36), the identity where theta = 0.

    theta (3, N); D, out (3, 3, N) with [i, component, point]; out may be D itself. Angles up to
    1 rad, which is what steps are made of, take a series that vectorises.
    """
    largest = 0.0
    for k in range(np.uint64(theta.shape[1])):
        angle2 = theta[0, k] ** 2 + theta[1, k] ** 2 + theta[2, k] ** 2
        largest = angle2 if angle2 > largest else largest
    if largest <= SERIES_UP_TO:
        for k in range(np.uint64(theta.shape[1])):
            tx, ty, tz = theta[0, k], theta[1, k], theta[2, k]
            a, b = _series(tx * tx + ty * ty + tz * tz)
            _turn(a, b, tx, ty, tz, D, k, out)
        return
    for k in range(theta.shape[1]):
        tx, ty, tz = theta[0, k], theta[1, k], theta[2, k]
        angle2 = tx * tx + ty * ty + tz * tz
        a, b = _series(angle2) if angle2 <= SERIES_UP_TO else _closed_form(angle2)
        _turn(a, b, tx, ty, tz, D, k, out)


@kernel(f"void({STATE}, {VEC}, {STATE})")
def displace(base, y, out):
    """Write the state with increments ``y`` from ``base``: (position, director, tracer) each.

    y: (X - X_n, theta, tracer - tracer_n), flat, 6 N + 3 P long; see :mod:`rodsim.scene.system`.
    """
    n, markers = base[0].shape[1], base[2].shape[1]
    _add(base[0], y[: 3 * n].reshape(3, n), out[0])
    rotate(y[3 * n : 6 * n].reshape(3, n), base[1], out[1])
    _add(base[2], y[6 * n :].reshape(3, markers), out[2])


def angular_velocity(theta: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Return w of triads exp(theta x) D where d theta/dt is ``rate``; all (3, N).

    w = rate + (1 - cos a)/a^2 theta x rate + (a - sin a)/a^3 theta x (theta x rate), a = |theta|:
    the differential of exp, of which ``rotation_vector_rate`` is the inverse.
    """
    angle2 = np.sum(theta**2, axis=0)
    angle = np.sqrt(angle2)
    first = 0.5 * np.sinc(angle / (2.0 * np.pi)) ** 2
    small = angle2 < 1e-2
    series = 1.0 / 6.0 - angle2 / 120.0 * (1.0 - angle2 / 42.0 * (1.0 - angle2 / 72.0))
    second = np.where(small, series, (1.0 - np.sinc(angle / np.pi)) / np.where(small, 1.0, angle2))
    turned = cross(theta, rate)
    return rate + first * turned + second * cross(theta, turned)


@unsigned
def rotation_vector_rate(theta, w):
    """Replace the angular velocity w by d theta/dt = w - 1/2 theta x w + 1/12 theta x (theta x w).

    The series of the inverse differential of exp, cut after the terms that a method of order 4
    needs; both arrays (3, N).
    """
    for k in range(np.uint64(theta.shape[1])):
        tx, ty, tz = theta[0, k], theta[1, k], theta[2, k]
        wx, wy, wz = w[0, k], w[1, k], w[2, k]
        cx, cy, cz = ty * wz - tz * wy, tz * wx - tx * wz, tx * wy - ty * wx
        w[0, k] = wx - 0.5 * cx + (ty * cz - tz * cy) / 12.0
        w[1, k] = wy - 0.5 * cy + (tz * cx - tx * cz) / 12.0
        w[2, k] = wz - 0.5 * cz + (tx * cy - ty * cx) / 12.0
