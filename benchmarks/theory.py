"""Exact and asymptotic results that the figures and the tests hold rodsim against (needs scipy).

K_n are modified Bessel functions of the second kind at x = k eps. An infinite straight rod of the
blob (12) answers loads exp(i k z) with the mobilities of ``mobilities``: line integrals of the
kernels (61)-(68), all exact. Symbols of the paper: mu viscosity, a moduli of bending (a3 of
twisting), b of shear (b3 of stretch), k wavenumber, sigma frequency.
"""

import numpy as np
from scipy.special import kn

SLENDER_RADIUS = np.exp(-0.5)  # a / eps: the cylinder that moves as the regularised line does
SPIN_RADIUS = np.sqrt(0.5)  # the same for spin about the axis


def mobilities(k, epsilon, viscosity):
    """Return M_perp, M_par, q, D_perp, M_twist of an infinite line at wavenumber k.

    Velocity per force density along y: M_perp; along z: M_par; angular velocity per torque density
    about x: D_perp; about z: M_twist; q couples force along y and torque about x.
    """
    x = k * epsilon
    k0, k1, k2, k3 = (kn(n, x) for n in range(4))
    pi_mu = np.pi * viscosity
    return (
        (k0 + x * k1) / (4 * pi_mu),
        k0 / (2 * pi_mu),
        (2 * k * k0 + epsilon * k**2 * k1) / (8 * pi_mu),
        (-4 * k / epsilon * k1 - 2 * k**2 * k2 + 2 * k**3 * epsilon * k3) / (32 * pi_mu),
        (2 * k / epsilon * k1 + k**2 * k2) / (8 * pi_mu),
    )


def lattice_wavenumber(k, spacing):
    """Return 2 sin(k ds/2)/ds, which takes k's place in the differences of a rod of points."""
    return 2.0 * np.sin(0.5 * k * spacing) / spacing


def bending_modes(k, epsilon, viscosity, bending, shear, spacing=0.0):
    """Return rates (< 0, 1/time) and tilts of the two modes y = cos(k z), tilt = r sin(k z).

    Eigenvalues and r = Im(v_2/v_1) of the eigenvectors v of
    [[M_perp, -iq], [iq, D_perp]] [[-b K^2, -i b K c], [i b K c, -(a K^2 + b c^2)]]
    with K = k, c = 1; on a rod of points K is the lattice's wavenumber and c = cos(k ds/2), since
    a half triad has the mean tilt. The first mode is bending, the second, faster one shear. The
    tilt turns the triads about x.
    """
    perp, _, q, turn, _ = mobilities(k, epsilon, viscosity)
    K = lattice_wavenumber(k, spacing) if spacing else k
    c = np.cos(0.5 * k * spacing)
    mobility = np.array([[perp, -1j * q], [1j * q, turn]])
    stiffness = np.array(
        [
            [-shear * K**2, -1j * shear * K * c],
            [1j * shear * K * c, -(bending * K**2 + shear * c**2)],
        ]
    )
    rates, vectors = np.linalg.eig(mobility @ stiffness)
    order = np.argsort(-rates.real)
    return rates.real[order], (vectors[1] / vectors[0]).imag[order]


def taylor_speed(k, amplitude, frequency, radius):
    """Return V of (51): a thin waving cylinder, amplitude small, k r_c << 1 (Taylor 1952)."""
    k0 = kn(0, k * radius)
    return 0.5 * k * frequency * amplitude**2 * (k0 - 0.5) / (k0 + 0.5)


def taylor_radius(k, factor):
    """Return the radius r_c at which the factor of (51) is ``factor``, 0 <= factor < 1."""
    from scipy.optimize import brentq

    return brentq(lambda r: taylor_speed(k, 1.0, 2.0 / k, r) - factor, 1e-12 / k, 0.9 / k)


def swimming_speed(k, amplitude, frequency, epsilon, viscosity):
    """Return V of the infinite regularised filament, exact to second order in the amplitude.

    The wave y = b sin(k z - sigma t) is prescribed with its tilt; F, m are the amplitudes of force
    and torque density that drive it, and V is the mean flow they make at the moving line.
    """
    x = k * epsilon
    k0, k1, k2 = (kn(n, x) for n in range(3))
    perp, _, q, turn, _ = mobilities(k, epsilon, viscosity)
    rate = amplitude * frequency
    force, torque = np.linalg.solve([[perp, -q], [-q, turn]], [rate, -rate * k])
    by_force = amplitude * force * k * k0 / (8 * np.pi * viscosity)
    by_torque = amplitude * torque / (32 * np.pi * viscosity)
    return by_force + by_torque * (8 / epsilon**2 - 4 * k / epsilon * k1 - 2 * k**2 * k2)


def ring_threshold(intrinsic, mode=2):
    """Return Omega_3 r_0 above which a ring of equal moduli buckles, or 0 if it always does.

    ``intrinsic``: Omega_1 r_0. From the linear equations of an inextensible, unshearable ring,
    (Omega_3 r_0)^2 = (n^2 - 1)(n^2 - kappa^2)/(n^2 + kappa); for kappa = 0 Michell's sqrt(3). No
    fluid enters. Derived here: a t x t'' + (N_3 t)' - a kappa D^1' + t x F = 0, N_3' = -a kappa
    D^1.t', linear in small out-of-plane and radial tilts and a turn of D^1, modes cos(n s/r_0).
    """
    n2 = mode**2
    return np.sqrt(np.maximum(0.0, (n2 - 1) * (n2 - intrinsic**2) / (n2 + intrinsic)))


def rod_drag(length, radius):
    """Return drag coefficients over mu of a straight cylinder: endwise, broadside, end over end.

    Force/(mu U) twice, torque/(mu Omega). Batchelor, J. Fluid Mech. 44 (1970) 419-440, with
    e = 1/ln(length/radius); the error is of order e^4.
    """
    e = 1.0 / np.log(length / radius)
    half = 0.5 * length
    return (
        4 * np.pi * half * (e * (1 + 0.307 * e) / (1 - 0.5 * e) + 0.426 * e**3),
        8 * np.pi * half * (e * (1 + 0.307 * e) / (1 + 0.5 * e) + 0.119 * e**3),
        8 / 3 * np.pi * half**3 * (e * (1 + 0.640 * e) / (1 - 0.5 * e) + 1.659 * e**3),
    )
