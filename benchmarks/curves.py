"""Curves of many points at steps ``DS``: a suspension, a smooth random coil, a wound knot."""

import numpy as np

DS, EPSILON = 0.1, 0.5


def suspension(rods, points=1000, seed=0):
    """Return (3, N) and the points of each rod: bent fibres at random in a box, L apart or so."""
    rng, length = np.random.default_rng(seed), points * DS
    s, box = np.arange(points) * DS, 0.7 * rods ** (1 / 3) * points * DS
    fibres = []
    for _ in range(rods):
        frame, angle = np.linalg.qr(rng.normal(size=(3, 3)))[0], 2.0 * s / length
        bent = 0.5 * length * np.stack([np.sin(angle), 1.0 - np.cos(angle), 0.2 * angle])
        fibres.append(frame @ bent + rng.uniform(-0.5 * box, 0.5 * box, (3, 1)))
    return np.ascontiguousarray(np.concatenate(fibres, axis=1)), [points] * rods


def coil(points, persistence=25.0, seed=1):
    """Return the same of one curve whose tangents forget themselves over so many epsilon.

    Curvature is noise that is smooth over a quarter of that length.
    """
    rng, length = np.random.default_rng(seed), persistence * EPSILON / DS
    width = max(4, int(length / 4))
    window = np.hanning(2 * width + 1)
    window /= window.sum()
    noise = rng.normal(size=(2, points + 2 * width)) * np.sqrt(1.0 / length)
    bend = np.array([np.convolve(row, window, "valid") for row in noise])
    tangent, normal = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    tangents = np.empty((3, points))
    for k in range(points):
        tangents[:, k] = tangent
        side = np.cross(tangent, normal)
        tangent = tangent + bend[0, k] * normal + bend[1, k] * side
        tangent /= np.linalg.norm(tangent)
        normal = normal - (normal @ tangent) * tangent
        normal /= np.linalg.norm(normal)
    return np.ascontiguousarray(np.cumsum(tangents, axis=1) * DS), [points]


def knot(points):
    """Return the same of a trefoil that is wound around itself, 40 turns for each 1000 points."""
    t, turns = np.arange(points) / points * 2.0 * np.pi, 40 * points // 1000
    middle = np.array(
        [np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)]
    )
    scale = points * DS / 30.0
    wound = 0.3 * np.array([np.cos(turns * t), np.sin(turns * t), np.sin(turns * t + 1.0)])
    return np.ascontiguousarray(scale * middle + wound), [points]


SCENES = {
    "suspension": lambda points: suspension(points // 1000),
    "coil, 25 epsilon": coil,
    "coil, 8 epsilon": lambda points: coil(points, 8.0),
    "wound knot": knot,
}
