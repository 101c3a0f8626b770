"""Slow, obvious twins of the fast kernels: textbook formulas, one pair and one point at a time.

They share no code and no algebra with ``rodsim``: the scalars are rational functions of R as the
paper's appendix prints them, the half triads come from scipy's matrix logarithm.
"""

import numpy as np
from scipy.linalg import expm, logm


def psi(blob, r, e):
    """The blobs as printed: (12) and (13)."""
    if blob == "algebraic7":
        return 15 * e**4 / (8 * np.pi * (r**2 + e**2) ** 3.5)
    return 15 * e**6 * (5 - 2 * r**2 / e**2) / (16 * np.pi * (r**2 + e**2) ** 4.5)


def enclosed(blob, r, e):
    """Integral of psi over the ball of radius r, by quadrature: 4 pi int_0^r psi x^2 dx."""
    x, w = np.polynomial.legendre.leggauss(200)
    x, w = 0.5 * r * (x + 1), 0.5 * r * w
    return 4 * np.pi * np.sum(w * psi(blob, x, e) * x**2)


def scalars(blob, r, e):
    """H1, H2, Q, D1, D2 in powers of R: (63)-(68) for (12), the same derivation for (13)."""
    R = (r**2 + e**2) ** 0.5
    if blob == "algebraic7":
        values = (
            (2 * e**2 + r**2) / R**3,
            1 / R**3,
            (5 * e**2 + 2 * r**2) / R**5,
            (10 * e**4 - 7 * e**2 * r**2 - 2 * r**4) / R**7,
            (21 * e**2 + 6 * r**2) / R**7,
        )
    else:
        values = (
            (3 * e**4 + 5 / 2 * e**2 * r**2 + r**4) / R**5,
            (5 / 2 * e**2 + r**2) / R**5,
            (25 / 2 * e**4 + 7 * e**2 * r**2 + 2 * r**4) / R**7,
            (25 * e**6 - 69 / 2 * e**4 * r**2 - 9 * e**2 * r**4 - 2 * r**6) / R**9,
            (147 / 2 * e**4 + 27 * e**2 * r**2 + 6 * r**4) / R**9,
        )
    return tuple(value / (8 * np.pi) for value in values)


def velocity(targets, sources, forces, torques, epsilon, viscosity, blob):
    """Eqs. (61), (66) summed one pair at a time."""
    u, w = np.zeros_like(targets), np.zeros_like(targets)
    for i, x in enumerate(targets):
        for source, f, n in zip(sources, forces, torques, strict=True):
            d = x - source
            h1, h2, q, d1, d2 = scalars(blob, np.linalg.norm(d), epsilon)
            u[i] += f * h1 + f.dot(d) * d * h2 + 0.5 * np.cross(n, d) * q
            w[i] += 0.5 * np.cross(f, d) * q + 0.25 * n * d1 + 0.25 * n.dot(d) * d * d2
    return u / viscosity, w / viscosity


def half_triad(first, second):
    """Rows of both are triads; the principal square root of the rotation between them, by logm."""
    rotation = second.T @ first  # sum_i D_(k+1)^i (D_k^i)^T
    return first @ expm(0.5 * logm(rotation).real).T


def rod_loads(X, D, omega, ds, moduli, closed):
    """Eqs. (23)-(31) of one rod. X (M, 3), D (M, 3, 3) with rows D^i, omega (segments, 3)."""
    M = len(X)
    F, N, dX = np.zeros((M, 3)), np.zeros((M, 3)), np.zeros((M, 3))
    for k in range(M if closed else M - 1):
        j = (k + 1) % M
        half = half_triad(D[k], D[j])
        dX[k] = X[j] - X[k]
        for i in range(3):
            a, b = (i + 1) % 3, (i + 2) % 3
            strain = (D[j, a] - D[k, a]).dot(half[b]) / ds
            N[k] += moduli[i] * (strain - omega[k, i]) * half[i]
            F[k] += moduli[3 + i] * (half[i].dot(dX[k]) / ds - (i == 2)) * half[i]
    g, m = np.zeros((M, 3)), np.zeros((M, 3))
    for k in range(M):
        before = k - 1  # of an open rod's first point: the last row, where there is no segment
        g[k] = F[k] - F[before]
        m[k] = N[k] - N[before] + 0.5 * (np.cross(dX[k], F[k]) + np.cross(dX[before], F[before]))
    return g, m


def gap(X, counts, closed, excluded):
    """Smallest distance of two points of different rods, or more than so many segments apart."""
    rod = np.repeat(np.arange(len(counts)), counts)
    number = np.concatenate([np.arange(count) for count in counts])
    smallest = np.inf
    for i in range(len(X)):
        for j in range(i):
            r, apart = rod[i], number[i] - number[j]
            if closed[r]:
                apart = min(apart, counts[r] - apart)
            if rod[j] != r or apart > excluded[r]:
                d = X[j] - X[i]
                smallest = min(smallest, np.sqrt(d[0] ** 2 + d[1] ** 2 + d[2] ** 2))
    return smallest


def pairs_that_count(X, rods, excluded):
    """Distance of every two points that are no neighbours along a rod, by their numbers i < j."""
    rod = np.repeat(np.arange(len(rods)), rods.count)
    number = np.concatenate([np.arange(count) for count in rods.count])
    apart = abs(number[:, None] - number)
    round_about = np.where(rods.closed, rods.count, 10**9)[rod][:, None] - apart
    counts = (rod[:, None] != rod) | (np.minimum(apart, round_about) > excluded[rod][:, None])
    distance = np.linalg.norm(X[:, None] - X, axis=2)
    return {(i, j): distance[i, j] for i, j in np.argwhere(np.triu(counts, 1)).tolist()}
