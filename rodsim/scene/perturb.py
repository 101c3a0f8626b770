"""A smooth, reproducible disturbance of a rod's start, to wake what symmetry keeps asleep.

With L the unstressed length and s = k ds of point k, an open rod is moved and twisted by

    delta(s) = A sum_m c_m cos(pi m s/L)/m^2,                          m = 1 ... modes,

a closed one by the same sum of c_m cos(2 pi m s/L) + c'_m sin(2 pi m s/L). The three components of
c_m and c'_m, in space, and the one of the twist come from a generator that is the same on all
machines; each mode bends the rod alike. delta has the root mean square ``amplitude`` over the rod,
whatever the number of points; the angle of the twist that of 2 pi amplitude/L.
"""

from __future__ import annotations

import numpy as np

from rodsim.vectors import cross

STEEPEST = 0.5  # of abs(d delta/ds): beyond it the triads do not follow what moves


def perturb(position, director, spacing, closed, how, planar):
    """Return position (3, M) and director (3, 3, M) of a rod disturbed as ``how`` says.

    D^3 is turned to D^3 + d delta/ds by the shortest rotation, and the other two with it; then all
    are twisted about it. ``planar``: nothing leaves the plane of constant x. Raises ValueError
    where ``how`` asks for more than the rod can follow.
    """
    points = position.shape[1]
    segments = points if closed else points - 1
    if how.modes > segments // 2:
        raise ValueError(f"modes = {how.modes}: {points} points show at most {segments // 2}")
    length = segments * spacing
    waves = (2.0 if closed else 1.0) * np.pi * np.arange(1, how.modes + 1) / length
    shift, slope = _series(_coefficients(how, closed, planar), waves, np.arange(points) * spacing)
    shift, slope = how.amplitude * shift, how.amplitude * slope
    steepest = np.sqrt((slope[:3] ** 2).sum(axis=0)).max()
    if steepest > STEEPEST:
        fitting = STEEPEST / steepest * how.amplitude
        raise ValueError(
            f"bends the rod by up to {steepest:.2g} rad: amplitude at most {fitting:.2g}"
        )
    tilted = _turned_along(director, director[2] + slope[:3])
    angle = 2.0 * np.pi / length * shift[3]
    return position + shift[:3], tilted if planar else _twisted(tilted, angle)


def _coefficients(how, closed, planar):
    """Return (cos and sin, x y z and twist, modes), with 1/m^2 in them, of root mean square 1.

    x, y and z have the same share of it, so that no seed disturbs a rod along its axis alone.
    Taken from the bits of the generator: what NumPy makes of them may change, they do not.
    """
    bits = np.random.PCG64(how.seed).random_raw((how.modes, 4, 2)) >> np.uint64(11)
    found = (bits * 2.0**-52 - 1.0).transpose(2, 1, 0) / np.arange(1, how.modes + 1) ** 2
    if not closed:
        found[1] = 0.0
    if planar:
        found[:, 0] = 0.0
    square = 0.5 * (found**2).sum(axis=(0, 2))
    found /= np.sqrt(np.where(square > 0.0, square, 1.0))[:, None]
    found[:, :3] /= np.sqrt(2.0 if planar else 3.0)
    return found


def _series(coefficients, waves, s):
    """Return the sums (4, M) at arc lengths s, and their derivatives."""
    even, odd = coefficients
    cos, sin = np.cos(waves[:, None] * s), np.sin(waves[:, None] * s)
    return even @ cos + odd @ sin, (odd * waves) @ cos - (even * waves) @ sin


def _turned_along(director, along):
    """Turn triads by the shortest rotation that takes D^3 to the direction of ``along`` (3, M).

    R v = v + a x v + a x (a x v)/(1 + D^3 . t), with a = D^3 x t and t the unit vector of along.
    """
    t = along / np.linalg.norm(along, axis=0)
    axis, cos = cross(director[2], t), (director[2] * t).sum(axis=0)

    def turn(v):
        once = cross(axis, v)
        return v + once + cross(axis, once) / (1.0 + cos)

    return np.array([turn(director[0]), turn(director[1]), t])


def _twisted(director, angle):
    first, second, third = director
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([cos * first + sin * second, cos * second - sin * first, third])
