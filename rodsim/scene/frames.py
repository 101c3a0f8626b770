"""Triads along a curve that turn as little as they can: parallel transport."""

import numpy as np


def transported(tangent, normal, closed=False, turns=0.0):
    """Return triads (M, 3, 3), [k, i, :] = D^(i+1), along unit tangents (M, 3).

    D^3 is the tangent. D^1 begins as near to ``normal`` as it can be across it, and goes from point
    to point by the smallest rotation that takes one tangent to the next, so the discrete twist
    (D^1' . D^2) is 0. ``turns`` whole turns about the tangent, right-handed, are spread evenly over
    the rod; on a closed one also the angle, at most half a turn, by which the frame would miss
    itself. Its linking number is then the whole number nearest to the writhe plus ``turns``.
    """
    after = np.roll(tangent, -1, axis=0)[: len(tangent) if closed else -1]
    rotations = smallest_rotations(tangent[: len(after)], after)
    total = _products(np.concatenate([np.eye(3)[None], rotations]))  # to each point, and around
    if abs(np.dot(normal, tangent[0])) > 1.0 - 1e-6:
        normal = np.eye(3)[np.argmin(np.abs(tangent[0]))]
    first = _across(normal, tangent[0])
    around = total @ first
    angle = 2.0 * np.pi * turns
    if closed:
        sine = np.dot(np.cross(around[-1], first), tangent[0])
        angle += np.arctan2(sine, np.dot(around[-1], first))
    count = len(tangent)
    share = np.arange(count) / (count if closed else count - 1)
    one = _across(around[:count], tangent)
    two = np.cross(tangent, one)
    cos, sin = np.cos(angle * share)[:, None], np.sin(angle * share)[:, None]
    return np.stack([cos * one + sin * two, cos * two - sin * one, tangent], axis=1)


def smallest_rotations(before, after):
    """Return the rotations (n, 3, 3) about b x a that take unit vectors b (n, 3) to a.

    R = 1 + K + K^2/(1 + b.a), K v = (b x a) x v; not finite for opposite ones.
    """
    x, y, z = np.cross(before, after).T
    zero = np.zeros_like(x)
    cross = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = 1.0 / (1.0 + np.einsum("kc,kc->k", before, after))
    return np.eye(3) + cross + share[:, None, None] * (cross @ cross)


def plane_normal(position):
    """Return the unit normal of the plane nearest to points (M, 3), its largest part positive.

    Of points in a straight line: the first axis, or the second where the line is along the first.
    """
    centred = position - position.mean(axis=0)
    _, sizes, axes = np.linalg.svd(centred, full_matrices=False)
    if len(sizes) < 3 or sizes[1] <= 1e-9 * sizes[0]:
        along = axes[0] if len(axes) else np.zeros(3)
        return np.eye(3)[0 if abs(along[0]) < 0.9 else 1]
    normal = axes[2]
    return normal * np.sign(normal[np.argmax(np.abs(normal) - 1e-9 * np.arange(3))])


def _products(matrices):
    """Return the products M_k ... M_1 M_0 of all k, by doubling."""
    total, shift = matrices.copy(), 1
    while shift < len(total):
        total[shift:] = total[shift:] @ total[:-shift]
        shift *= 2
    return total


def _across(vector, tangent):
    across = vector - np.sum(vector * tangent, axis=-1, keepdims=True) * tangent
    return across / np.linalg.norm(across, axis=-1, keepdims=True)
