"""Shapes of a case file -> positions and triads of one rod, numpy only.

Every function returns position (3, M) and director (3, 3, M), [i, component, point]. The first
point is at s = 0; points are at equal steps of arc length; D^3 is the unit tangent (for the
perturbed straight rod of (40)-(43): nearly).
"""

import numpy as np

from rodsim.scene.arcs import equal_arcs
from rodsim.vectors import cross


def straight(shape):
    """Eqs. (40)-(43): the z axis stretched by 1 + xi, triads turned about x by xi."""
    s = np.arange(shape.points) * shape.ds
    xi = shape.perturbation
    position = np.zeros((3, shape.points))
    position[2] = (1.0 + xi) * s
    triad = np.array([[1, 0, 0], [0, np.cos(xi), -np.sin(xi)], [0, np.sin(xi), np.cos(xi)]])
    return position, np.repeat(triad[:, :, None], shape.points, axis=2)


def ring(shape):
    """Eqs. (46)-(49): a circle in the x-y plane, triads twisted by xi sin(s/r_0)."""
    angle = 2.0 * np.pi * np.arange(shape.points) / shape.points
    twist = shape.twist_perturbation * np.sin(angle)
    zero = np.zeros_like(angle)
    radial = np.array([np.cos(angle), np.sin(angle), zero])
    axial = np.array([zero, zero, zero + 1.0])
    tangent = np.array([-np.sin(angle), np.cos(angle), zero])
    first = np.cos(twist) * axial + np.sin(twist) * radial
    second = -np.sin(twist) * axial + np.cos(twist) * radial
    return shape.radius * radial, np.array([first, second, tangent])


def helix(shape):
    """A helix about z, right-handed for pitch > 0; D^1 is the binormal, D^2 minus the normal.

    With these triads its own strain twist is (curvature, 0, torsion).
    """
    if shape.taper is not None:
        return _tapered_helix(shape)
    rise = shape.pitch / (2.0 * np.pi)
    stride = np.hypot(shape.radius, rise)  # arc length per radian
    angle = np.arange(shape.points) * shape.ds / stride
    cos, sin, one = np.cos(angle), np.sin(angle), np.ones_like(angle)
    position = np.array([shape.radius * cos, shape.radius * sin, rise * angle])
    tangent = np.array([-shape.radius * sin, shape.radius * cos, rise * one]) / stride
    outward = np.array([cos, sin, 0.0 * one])
    return position, np.array([cross(outward, tangent), outward, tangent])


def _tapered_helix(shape):
    """A helix that starts on its axis: its radius is R(z) = radius (1 - exp(-(z/taper)^2)).

    D^2 is the direction outwards made normal to the tangent, as of the plain helix, which it
    becomes beyond a few tapers.
    """
    k, taper = 2.0 * np.pi / abs(shape.pitch), shape.taper

    def radius(x):
        return -shape.radius * np.expm1(-((x / taper) ** 2))

    def growth(x):
        return 2.0 * shape.radius * x / taper**2 * np.exp(-((x / taper) ** 2))

    def speed(x):
        return np.sqrt(1.0 + growth(x) ** 2 + (k * radius(x)) ** 2)

    target = np.arange(shape.points) * shape.ds
    cell = min(abs(shape.pitch) / 16.0, taper / 4.0)
    edges = np.arange(int(np.ceil(target[-1] / cell)) + 2) * cell
    x = equal_arcs(speed, edges, target, max(target[-1], cell))
    cos, sin, zero, one = np.cos(k * x), np.sin(k * x), np.zeros_like(x), np.ones_like(x)
    outward, around = np.array([cos, sin, zero]), np.array([-sin, cos, zero])
    up = np.array([zero, zero, np.copysign(one, shape.pitch)])
    position = radius(x) * outward + x * up
    tangent = (growth(x) * outward + k * radius(x) * around + up) / speed(x)
    first = cross(outward, tangent)
    first /= np.linalg.norm(first, axis=0)
    return position, np.array([first, cross(tangent, first), tangent])


def sine(shape):
    """y = amplitude sin(2 pi z / wavelength + phase) in the plane x = 0, D^1 = x."""
    k = 2.0 * np.pi / shape.wavelength

    def slope(z):
        return shape.amplitude * k * np.cos(k * z + shape.phase)

    def speed(z):
        return np.hypot(1.0, slope(z))

    target = np.arange(shape.points) * shape.ds
    cell = min(shape.wavelength / 64.0, max(shape.ds * shape.points, 1e-300))
    edges = np.arange(int(np.ceil(target[-1] / cell)) + 2) * cell
    z = equal_arcs(speed, edges, target, max(target[-1], cell))
    one, zero = np.ones_like(z), np.zeros_like(z)
    position = np.array([zero, shape.amplitude * np.sin(k * z + shape.phase), z])
    tangent = np.array([zero, slope(z), one]) / np.hypot(slope(z), 1.0)
    first = np.array([one, zero, zero])
    return position, np.array([first, cross(tangent, first), tangent])


def place(position, director, shape):
    """Turn a rod about the origin by ``shape.rotate``, then move it to ``shape.origin``."""
    if shape.rotate is not None:
        turn = rotation_matrix(shape.rotate.axis, np.radians(shape.rotate.degrees))
        position = turn @ position
        director = np.einsum("ab,ibk->iak", turn, director)
    return position + np.asarray(shape.origin, float)[:, None], director


def rotation_matrix(axis, angle):
    """Rotation by ``angle`` (rad) about ``axis``, eq. (36), exact for whole quarter turns."""
    e = np.asarray(axis, float) / np.linalg.norm(axis)
    quarters = angle / (0.5 * np.pi)
    cos, sin = np.cos(angle), np.sin(angle)
    if abs(quarters - round(quarters)) < 1e-12:
        cos, sin = np.round(cos), np.round(sin)
    cross = np.array([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]])
    return cos * np.eye(3) + (1.0 - cos) * np.outer(e, e) + sin * cross


FORMULAS = {"straight": straight, "ring": ring, "helix": helix, "sine": sine}
