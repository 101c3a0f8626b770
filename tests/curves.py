"""Curves for tests of the fast sums: smooth, with what a rod's points have of order and length."""

import numpy as np


def arc(points, spacing, seed):
    """Return (points, 3) of a piece of a helix at a random place, points at equal arc steps."""
    rng = np.random.default_rng(seed)
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    radius, climb = rng.uniform(7.0, 19.0), rng.uniform(0.1, 0.6)
    angle = np.arange(points) * spacing / (radius * np.hypot(1.0, climb))
    helix = radius * np.stack([np.cos(angle), np.sin(angle), climb * angle], axis=1)
    return helix @ frame + rng.uniform(-13.0, 13.0, 3)


def suspension(counts, spacing=0.11, seed=3):
    """Return (N, 3): some arcs, one after another."""
    return np.concatenate([arc(n, spacing, seed + k) for k, n in enumerate(counts)])


def random_loads(n, epsilon, seed=17):
    """Return forces and torques (n, 3) that have nothing to do with each other: the worst case."""
    g, m = np.random.default_rng(seed).normal(size=(2, n, 3))
    return g, epsilon * m
