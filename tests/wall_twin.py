"""A slow twin of the sums at a wall: superposed images, differentiated numerically in 80 digits.

Of the scalars only H1, H2 and Q are taken, as printed; all others, the doublet, torques (couples of
forces) and the angular velocity (half the curl) are central differences. No algebra of
``rodsim/flows/wall.py`` is used.
"""

import numpy as np
import twins
from mpmath import mp, mpf

DIGITS, STEP = 80, mpf(10) ** -14  # three nested differences: truncation 1e-28, rounding 1e-38
AXES = np.array([[mpf(i == k) for i in range(3)] for k in range(3)])


def velocity(x, X, g, m, epsilon, viscosity, blob):
    """Return u and w (3,) at x from a force g and a torque m at X, above the wall z = 0."""
    with mp.workdps(DIGITS):
        x, X, g, m = exact(x, X, g, m)

        def u(y):
            return with_couple(force_velocity, y, X, g, m, mpf(epsilon), blob)

        w = sum(np.cross(axis, derivative(u, x, axis)) for axis in AXES) / 2
        return rounded(u(x) / mpf(viscosity)), rounded(w / mpf(viscosity))


def pressure(x, X, g, m, epsilon, blob):
    """Return the pressure at x."""
    with mp.workdps(DIGITS):
        return float(with_couple(force_pressure, *exact(x, X, g, m), mpf(epsilon), blob))


def stokes_residual(x, X, g, m, epsilon, viscosity, blob):
    """Return mu Laplacian u - grad p at x, and grad p for its size: 0 where no blob pushes."""
    with mp.workdps(DIGITS):
        rest = *exact(X, g, m), mpf(epsilon), blob
        x = exact(x)[0]

        def u(y):
            return with_couple(force_velocity, y, *rest)

        def p(y):
            return with_couple(force_pressure, y, *rest)

        laplacian = sum(u(x + STEP * a) - 2 * u(x) + u(x - STEP * a) for a in AXES) / STEP**2
        slope = np.array([derivative(p, x, a) for a in AXES])
        return rounded(laplacian - slope), rounded(slope)


def with_couple(field, x, X, g, m, e, blob):
    """Add to a field of forces that of a couple: half the curl, in X, of its force slot."""
    couple = [derivative(lambda Y, a=a: field(x, Y, np.cross(m, a), e, blob), X, a) for a in AXES]
    return field(x, X, g, e, blob) + sum(couple) / 2


def force_velocity(x, X, g, e, blob):
    """Return mu u of a force: two Stokeslets, doublet, dipole of the companion blob, rotlet."""
    up, h, r, image, b = geometry(x, X, g)
    distance = mp.sqrt(image.dot(image))

    def h_scalar(i):
        return lambda s: twins.scalars(blob, s, e)[i]

    h2 = h_scalar(1)(distance)
    slopes = [derivative(h_scalar(i), distance, 1) for i in (0, 1)]
    dipole = (-2 * h2 - distance * slopes[1]) * b + slopes[1] / distance * b.dot(image) * image
    rotlet = (slopes[0] / distance + h2) * np.cross(np.cross(up, g), image)
    doublet = derivative(lambda y: stokeslet(y, up, e, blob), image, b)
    images = -stokeslet(image, g, e, blob) - 2 * h * doublet + 2 * h**2 * dipole - 2 * h * rotlet
    return stokeslet(r, g, e, blob) + images


def force_pressure(x, X, g, e, blob):
    """Return the pressure of a force; the dipole and the rotlet have none."""
    up, h, r, image, b = geometry(x, X, g)

    def of_stokeslet(y, f):
        return twins.scalars(blob, mp.sqrt(y.dot(y)), e)[2] * f.dot(y)

    doublet = derivative(lambda y: of_stokeslet(y, up), image, b)
    return of_stokeslet(r, g) - of_stokeslet(image, g) - 2 * h * doublet


def stokeslet(r, g, e, blob):
    h1, h2, *_ = twins.scalars(blob, mp.sqrt(r.dot(r)), e)
    return g * h1 + g.dot(r) * r * h2


def geometry(x, X, g):
    """Return the wall's normal, the source's height, x - X, x - image of X, reflected force."""
    up, mirror = AXES[2], np.array([1, 1, -1])
    return up, X[2], x - X, x - mirror * X, mirror * g


def derivative(f, x, direction):
    return (f(x + STEP * direction) - f(x - STEP * direction)) / (2 * STEP)


def exact(*vectors):
    return [np.array([mpf(float(v)) for v in vector]) for vector in vectors]


def rounded(vector):
    return np.array([float(v) for v in vector])
