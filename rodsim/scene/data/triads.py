"""Triads of a table: rounding taken out, others refused."""

import numpy as np

from rodsim.errors import FileError

SILENT, LARGEST = 1e-4, 2e-2  # of abs(D D^T - 1): six decimals leave 1e-6, two leave 1e-2


def orthonormal(points):
    """Return the rotations (M, 3, 3) nearest to a file's triads, and a note or None.

    Raises FileError where an entry of D D^T is off by more than 0.02, or a triad is left-handed.
    """
    triads = points.director
    finite = np.isfinite(triads).all(axis=(1, 2))
    if not finite.all():
        raise FileError(f"{points.path}: {points.name(np.argmin(finite))}: the triad is not finite")
    gram = np.einsum("kic,kjc->kij", triads, triads)
    errors = np.abs(gram - np.eye(3)).max(axis=(1, 2))
    worst = int(np.argmax(errors))
    if errors[worst] > LARGEST:
        what = f"products of D1 D2 D3 are off by {errors[worst]:.3g}, above {LARGEST:g}"
        raise FileError(f"{points.path}: {points.name(worst)}: not an orthonormal triad: {what}")
    left_handed = np.linalg.det(triads) < 0.0
    if left_handed.any():
        what = "D1 D2 D3 is left-handed: two of them exchanged, or one negated?"
        raise FileError(f"{points.path}: {points.name(np.argmax(left_handed))}: {what}")
    left, _, right = np.linalg.svd(triads)
    note = None
    if errors[worst] > SILENT:
        note = f"its triads are off by up to {errors[worst]:.2g}: made orthonormal"
    return left @ right, note
