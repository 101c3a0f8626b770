"""Incompressible Navier-Stokes on a periodic grid of n^3 points, n even, by Fourier transforms.

    rho [(u^(n+1) - u^n)/dt + S(u^n) u^n] = -D p + mu L u^(n+1) + f,    D.u^(n+1) = 0

with D the central difference, L the seven-point Laplacian and S(u) v = 1/2 [u.D v + D.(u v)], the
skew-symmetric form, as the immersed boundary method has them. Viscosity is implicit, so the step is
not limited by it; the method is of order 1 in time and 2 in space. The velocity is kept as its
transform: a step takes three forward transforms and three backward ones.
"""

import numpy as np
from numba import prange

from gib.transforms import Transforms
from rodsim.compiled.flags import ONE, inline, parallel_kernel

ZERO = np.uint64(0)


class Fluid:
    """The fluid in a periodic cube.

    Attributes
    ----------
    velocity : (3, n, n, n), length/time. force : (3, n, n, n), force per volume; set or add to it
    before a step. spacing : h = box/n.
    """

    def __init__(self, n: int, box: float, density: float, viscosity: float, threads: int = 1):
        self.n, self.box, self.spacing = n, box, box / n
        self.density, self.viscosity = density, viscosity
        self.transforms = Transforms(n, threads)
        self.velocity = np.zeros((3, n, n, n))
        self.force = np.zeros((3, n, n, n))
        self._spectrum = np.zeros_like(self.transforms.spectrum)
        angle = 2.0 * np.pi * np.arange(n) / n
        self._slope = np.sin(angle) / self.spacing  # i times this is the symbol of D
        self._slope[[0, n // 2]] = 0.0  # exactly
        self._decay = (2.0 * np.sin(0.5 * angle) / self.spacing) ** 2  # and of -L

    def set_velocity(self, velocity: np.ndarray) -> None:
        """Start from a velocity (3, n, n, n) with D.u = 0."""
        self.velocity[:] = velocity
        self.transforms.real[:] = velocity
        self._spectrum[:] = self.transforms.forward()

    def advance(self, step: float) -> None:
        """Replace u^n by u^(n+1), and ``force`` by zero."""
        inertia = self.density / step
        work = self.transforms
        _explicit_terms(self.velocity, self.force, self.density, self.spacing, work.real)
        spectra = self._spectrum.view(float), work.forward().view(float)
        _solve(*spectra, self._slope, self._decay, inertia, self.viscosity)
        _copy(work.backward(), self.velocity)


@inline
def _carry(u, force, scale, i, j, k, ahead, behind, out):
    """One point of ``_explicit_terms``; ``ahead`` and ``behind``: its neighbours' indices."""
    ip, jp, kp = ahead
    im, jm, km = behind
    ux, uy, uz = u[0, i, j, k], u[1, i, j, k], u[2, i, j, k]
    right, left = ux + u[0, ip, j, k], ux + u[0, im, j, k]
    front, back = uy + u[1, i, jp, k], uy + u[1, i, jm, k]
    up, down = uz + u[2, i, j, kp], uz + u[2, i, j, km]
    for c in range(3):
        across = right * u[c, ip, j, k] - left * u[c, im, j, k]
        across += front * u[c, i, jp, k] - back * u[c, i, jm, k]
        across += up * u[c, i, j, kp] - down * u[c, i, j, km]
        out[c, i, j, k] = force[c, i, j, k] - scale * across
        force[c, i, j, k] = 0.0


@parallel_kernel
def _explicit_terms(u, force, density, h, out):
    """out = force - rho S(u) u; force = 0.

    Along axis a, S(u) u_c takes [(u_a + u_a+) u_c+ - (u_a + u_a-) u_c-]/(4 h) from the two
    neighbours on it: u.D u_c and D.(u u_c) share their products.
    """
    n = np.uint64(u.shape[1])
    last = n - ONE
    scale = density / (4.0 * h)
    for plane in prange(u.shape[1]):
        i = np.uint64(plane)
        ip, im = (i + ONE) % n, (i + last) % n
        for j in range(n):
            jp, jm = (j + ONE) % n, (j + last) % n
            _carry(u, force, scale, i, j, ZERO, (ip, jp, ONE), (im, jm, last), out)
            for k in range(ONE, last):
                _carry(u, force, scale, i, j, k, (ip, jp, k + ONE), (im, jm, k - ONE), out)
            _carry(u, force, scale, i, j, last, (ip, jp, ZERO), (im, jm, last - ONE), out)


@parallel_kernel
def _solve(spectrum, work, slope, decay, inertia, viscosity):
    """u^ = P (inertia u^ + f^)/(inertia + mu |L|) in place; ``work`` gets it over n^3 as well.

    Spectra are (3, n, n, 2 half), real and imaginary parts in turn: all factors are real. P takes
    out the part along D^. Where D^ = 0 (the mean, and modes that alternate from point to point)
    there is no pressure and nothing to take out.
    """
    n, twice = np.uint64(spectrum.shape[1]), np.uint64(spectrum.shape[3])
    scale = 1.0 / float(n) ** 3
    for plane in prange(spectrum.shape[1]):
        i = np.uint64(plane)
        dx = slope[i]
        for j in range(n):
            dy = slope[j]
            for m in range(twice):
                k = m >> ONE
                dz = slope[k]
                factor = 1.0 / (inertia + viscosity * (decay[i] + decay[j] + decay[k]))
                x = (inertia * spectrum[0, i, j, m] + work[0, i, j, m]) * factor
                y = (inertia * spectrum[1, i, j, m] + work[1, i, j, m]) * factor
                z = (inertia * spectrum[2, i, j, m] + work[2, i, j, m]) * factor
                length2 = dx * dx + dy * dy + dz * dz
                along = (dx * x + dy * y + dz * z) / (length2 if length2 > 0.0 else 1.0)
                x, y, z = x - dx * along, y - dy * along, z - dz * along
                spectrum[0, i, j, m], work[0, i, j, m] = x, scale * x
                spectrum[1, i, j, m], work[1, i, j, m] = y, scale * y
                spectrum[2, i, j, m], work[2, i, j, m] = z, scale * z


@parallel_kernel
def _copy(source, target):
    for i in prange(source.shape[1]):
        target[:, i] = source[:, i]
