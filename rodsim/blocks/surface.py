"""Points on the surface of a body, and the blob that makes of them a rigid no-slip surface.

On a surface of revolution with n points, point i < n/2 has the area (i + 1/2) A/n between it and
the pole z > 0, and the azimuth i pi (3 - sqrt 5), a golden spiral; the other half is its inversion
-p, so that no handedness is left. With h = sqrt(A/n) and x = ln(n/100) the blob and the depth of
the points under the surface,

    epsilon/h = 0.4911 + 0.03519 x + 0.00615 x^2      algebraic9: 0.7462, 0.05691, 0.00759
    inset/h   = 0.1016 + 0.01418 x + 0.00138 x^2                  0.0794, 0.01134, 0.00075

make both drag, 6 pi mu a, and torque, 8 pi mu a^3, of a sphere exact in the mean over directions
(a matched grid, as Broms et al. 2022 for rigid multiblobs). n = 100: 0.1 %; spheroids 0.5 to 0.9 %.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

GOLDEN = np.pi * (3.0 - np.sqrt(5.0))
MATCHED = {  # epsilon, inset: fitted at n = 50 to 600, to 5e-4 and 3e-4
    "algebraic7": ((0.4911, 0.03519, 0.00615), (0.1016, 0.01418, 0.00138)),
    "algebraic9": ((0.7462, 0.05691, 0.00759), (0.0794, 0.01134, 0.00075)),
}
FEWEST, MOST = 20, 2000  # points
CELLS = 4096  # of a meridian, on which its area is summed up
# A table of points has no normals: they stay on the surface, and this blob makes its drag right.
ON_SURFACE, NEIGHBOURS, PACKING = {"algebraic7": 0.37, "algebraic9": 0.61}, 6, 0.93


@dataclass(frozen=True)
class SurfacePoints:
    """points (3, n), with forces, in the body's own frame; normals (3, n) outwards, or None.

    epsilon : of their blobs. inset : how deep they lie below the surface.
    """

    points: np.ndarray
    normals: np.ndarray | None
    epsilon: float
    inset: float

    @property
    def skin(self) -> np.ndarray:
        """Points (3, n) of the surface itself."""
        return self.points if self.normals is None else self.points + self.inset * self.normals


def surface_of(shape, blob: str) -> SurfacePoints:
    """Return the points of a sphere, spheroid or spherocylinder of the case, axis along z."""
    n = shape.points
    share = (np.arange(n // 2) + 0.5) / n
    z, rho, normal_z, normal_rho, area = MERIDIANS[shape.kind](shape, share)
    azimuth = GOLDEN * np.arange(n // 2)
    cos, sin = np.cos(azimuth), np.sin(azimuth)
    half = np.array([rho * cos, rho * sin, z])
    normal = np.array([normal_rho * cos, normal_rho * sin, normal_z])
    h, x = np.sqrt(area / n), np.log(n / 100.0)
    epsilon, inset = (h * (a + b * x + c * x * x) for a, b, c in MATCHED[blob])
    half -= inset * normal
    points, normals = (np.hstack([one, -one]) for one in (half, normal))
    return SurfacePoints(np.ascontiguousarray(points), normals, float(epsilon), float(inset))


def _sphere(shape, share):
    a = shape.radius
    z = 1.0 - 2.0 * share
    rho = np.sqrt(1.0 - z * z)
    return a * z, a * rho, z, rho, 4.0 * np.pi * a * a


def _spherocylinder(shape, share):
    """The area between two planes across the axis is 2 pi r dz, on caps and cylinder alike."""
    r, length = shape.radius, shape.length
    half, straight = 0.5 * length, 0.5 * length - r
    z = half - share * length
    above = np.maximum(z - straight, 0.0) / r  # of the half sphere: cosine of the polar angle
    rho = np.sqrt(1.0 - above * above)
    return z, r * rho, above, rho, 2.0 * np.pi * r * length


def _spheroid(shape, share):
    """z = a cos u, rho = b sin u; dA = 2 pi b sin u sqrt(a^2 sin^2 u + b^2 cos^2 u) du."""
    a, b = 0.5 * shape.length, shape.radius
    u = np.linspace(0.0, np.pi, CELLS + 1)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    width = u[1] - u[0]
    at = u[:-1, None] + 0.5 * width * (nodes + 1.0)
    density = 2.0 * np.pi * b * np.sin(at) * np.hypot(a * np.sin(at), b * np.cos(at))
    below = np.append(0.0, np.cumsum(density @ weights) * 0.5 * width)
    area = below[-1]
    # cos u is a smooth function of the area, u itself is not at the poles
    cosine = np.interp(share * area, below, np.cos(u))
    sine = np.sqrt(1.0 - cosine * cosine)
    length = np.hypot(cosine / a, sine / b)
    return a * cosine, b * sine, cosine / a / length, sine / b / length, area


MERIDIANS = {"sphere": _sphere, "spheroid": _spheroid, "spherocylinder": _spherocylinder}


def surface_from(points: np.ndarray, blob: str) -> SurfacePoints:
    """Return the surface of given points (3, n), as they are; their spacing is measured.

    h^2, the area of a point, is that of a hexagonal lattice whose spacing is the mean distance of
    the six nearest neighbours.
    """
    square = (points**2).sum(axis=0)
    distance2 = square[:, None] + square - 2.0 * points.T @ points
    nearest = np.partition(distance2, NEIGHBOURS, axis=1)[:, : NEIGHBOURS + 1]
    nearest = np.sort(nearest, axis=1)[:, 1:]  # without the point itself
    h = PACKING * float(np.sqrt(np.maximum(nearest, 0.0)).mean())
    return SurfacePoints(np.ascontiguousarray(points), None, ON_SURFACE[blob] * h, 0.0)
