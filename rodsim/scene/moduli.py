"""Elastic moduli along a rod, at the middle of each segment."""

import numpy as np

from rodsim.case.fields import LARGEST, SMALLEST


def moduli_along(moduli, spacing: float, segments: int) -> np.ndarray:
    """Return a_1, a_2, a_3, b_1, b_2, b_3 of each segment, (6, S), at s = (k + 1/2) ds."""
    s = (np.arange(segments) + 0.5) * spacing
    rows = [value(s) if callable(value) else np.full(segments, value) for value in moduli.values]
    return np.array(rows)


def typical(along: np.ndarray) -> np.ndarray:
    """Return one value (6,) for each row (6, S): the value itself where all are the same."""
    return np.where(np.ptp(along, axis=1) > 0.0, along.mean(axis=1), along[:, 0])


def laid_out(rods: list[np.ndarray], counts) -> np.ndarray:
    """Return the moduli (6, N) of all segments, rod after rod; 0 for what an open rod has not."""
    table, begin = np.zeros((6, int(np.sum(counts)))), 0
    for along, count in zip(rods, counts, strict=True):
        table[:, begin : begin + along.shape[1]] = along
        begin += int(count)
    return table


def check_moduli(moduli, along: np.ndarray, spacing: float):
    """Yield (path below the rod, reason) where moduli along a rod are not positive."""
    for key, row in zip(moduli.keys, along, strict=True):
        bad = ~((row >= SMALLEST) & (row <= LARGEST))
        if bad.any():
            k = int(np.argmax(bad))
            at = f"is {row[k]:.4g} at s = {(k + 0.5) * spacing:.4g}"
            yield ("moduli", key), f"{at}: must be between {SMALLEST:g} and {LARGEST:g} everywhere"
