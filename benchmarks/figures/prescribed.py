"""The flagellum with its wave prescribed: no elasticity, no torques, no integrator, NumPy alone.

It shares nothing with rodsim but the blob (12), and so checks what rodsim finds at amplitudes
where no theory holds. The centreline is the one of curvature (50), tangent angle
psi = -k b cos(k s + sigma t), and is not stretched; forces at its points move it with the velocity
of the wave plus a rigid motion of the whole, such that no net force and no net torque act.
"""

import numpy as np


def speed(k, amplitude, frequency, epsilon, length, points=200, phases=12) -> float:
    """Return the swimming speed along z, a mean over ``phases`` times in a period."""
    period = 2 * np.pi / frequency
    args = k, amplitude, frequency, length, points
    speeds = []
    for time in np.arange(phases) / phases * period:
        X, small = _wave(*args, time), 1e-5 * period
        rate = (_wave(*args, time + small) - _wave(*args, time - small)) / (2 * small)
        speeds.append(_rigid_motion(X, rate, epsilon)[1])
    return float(np.mean(speeds))


def _wave(k, amplitude, frequency, length, points, time):
    """Return (y, z) of the centreline (2, M) about its centroid, by the trapezoid rule."""
    fine = np.linspace(0.0, length, 20 * (points - 1) + 1)
    angle = -k * amplitude * np.cos(k * fine + frequency * time)
    slope = np.array([np.sin(angle), np.cos(angle)])
    path = np.cumsum(0.5 * (slope[:, 1:] + slope[:, :-1]) * fine[1], axis=1)
    X = np.concatenate([np.zeros((2, 1)), path], axis=1)[:, ::20]
    return X - X.mean(axis=1, keepdims=True)


def _rigid_motion(X, rate, epsilon):
    """Return (V_y, V_z, rotation) that leaves a centreline in motion without force and torque."""
    points = X.shape[1]
    r = X[:, :, None] - X[:, None, :]
    R2 = (r**2).sum(axis=0) + epsilon**2
    h1, h2 = (R2 + epsilon**2) / R2**1.5, 1.0 / R2**1.5
    flow = [[(h1 if a == b else 0.0) + h2 * r[a] * r[b] for b in (0, 1)] for a in (0, 1)]
    rigid = np.zeros((2 * points, 3))
    rigid[:points, 0], rigid[points:, 1] = 1.0, 1.0
    rigid[:points, 2], rigid[points:, 2] = -X[1], X[0]
    system = np.block([[np.block(flow), -rigid], [rigid.T, np.zeros((3, 3))]])
    return np.linalg.solve(system, np.concatenate([*rate, np.zeros(3)]))[-3:]
