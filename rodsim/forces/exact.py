"""The exact gradient of the rod's energy, beside the paper's loads.

The moments of (24)-(26) are not quite those of the energy (6): the triads of half points turn with
both neighbours. With S = sin(phi/2) e = 1/2 ds sum_i strain_i D^i, phi the angle between
neighbouring triads, e its axis, c = cos(phi/2), and T = (X_(k+1) - X_k) x F, the moment whose
balance (31) is exactly -dE/dtheta is

    N* = N - S (S . N)/(2 q) + (T x S)/(4 q),    q = cos^2(phi/4) = (1 + c)/2.

It differs from N by phi^2/8 of N and phi/8 of T. Forces (30) are exact as they are, and what is
added to one point is taken from the next, so net force and torque stay zero. Runs keep the loads of
the paper; descents and symmetric Hessians need these.
"""

import math

import numpy as np

from rodsim.compiled.flags import unsigned
from rodsim.compiled.kernels import part
from rodsim.forces.elasticity import _uniform_loads, _varying_loads, segment_strain


@unsigned
def _difference(X, k, j, ds, strain, force, moment, half, extra):
    """Write N* - N of the segment from point k to point j into ``extra`` (3,).

    strain (6,), half (3, 3): of :func:`rodsim.forces.elasticity.segment_strain`; force, moment
    (3,): the components of F and N along the half point's triad.
    """
    s, f, n = np.zeros(3), np.zeros(3), np.zeros(3)
    for i in range(3):
        for c in range(3):
            s[c] += 0.5 * ds * strain[i] * half[i, c]
            f[c] += force[i] * half[i, c]
            n[c] += moment[i] * half[i, c]
    q = 0.5 + 0.5 * math.sqrt(1.0 - (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]))
    along = (s[0] * n[0] + s[1] * n[1] + s[2] * n[2]) / (2.0 * q)
    t = np.empty(3)
    for c in range(3):
        a, b = (c + 1) % 3, (c + 2) % 3
        t[c] = (X[a, j] - X[a, k]) * f[b] - (X[b, j] - X[b, k]) * f[a]
    for c in range(3):
        a, b = (c + 1) % 3, (c + 2) % 3
        extra[c] = (t[a] * s[b] - t[b] * s[a]) / (4.0 * q) - along * s[c]


@unsigned
def _correct(X, D, omega, rods, along, loads):
    """Add N* - N of every segment to the torques of its ends; ``along`` as for the loads."""
    strain, half, extra = np.empty(6), np.empty((3, 3)), np.empty(3)
    force, moment = np.empty(3), np.empty(3)
    firsts, counts, closed, spacing, moduli = rods
    for r in range(firsts.size):
        first, end = firsts[r], firsts[r] + counts[r]
        for k in range(first, end if closed[r] else end - 1):
            j = k + 1 if k + 1 < end else first
            segment_strain(X, D, k, j, spacing[r], strain, half)
            for i in range(3):
                a, b = moduli[i, r], moduli[3 + i, r]
                rest = 0.0
                if along.size:
                    a, b, rest = along[i, k], along[3 + i, k], along[6 + i, k]
                moment[i] = a * (strain[i] - omega[i, k])
                force[i] = b * (strain[3 + i] - rest)
            _difference(X, k, j, spacing[r], strain, force, moment, half, extra)
            for c in range(3):
                loads[3 + c, k] += extra[c]
                loads[3 + c, j] -= extra[c]


@part
def exact_elastic_loads(row, fixed, rods, state, loads, velocities):
    """The exact gradient of what :func:`rodsim.forces.elasticity.elastic_loads` is the load of."""
    omega, none = row.reshape(3, row.size // 3), fixed.reshape(0, 0)
    _uniform_loads(state[0], state[1], omega, rods, none, loads)
    _correct(state[0], state[1], omega, rods, none, loads)


@part
def exact_varying_loads(row, fixed, rods, state, loads, velocities):
    """The exact gradient of what :func:`rodsim.forces.elasticity.varying_loads` is the load of."""
    n = row.size // 3
    omega, along = row.reshape(3, n), fixed.reshape(9, n)
    _varying_loads(state[0], state[1], omega, rods, along, loads)
    _correct(state[0], state[1], omega, rods, along, loads)
