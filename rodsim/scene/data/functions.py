"""Tables of a function of s, or of s and t: (s, t, values) from a text file."""

from dataclasses import dataclass

import numpy as np

from rodsim.errors import FileError
from rodsim.scene.data.columns import find
from rodsim.scene.data.text import read_table

SAME = 1e-6  # relative, of two times that are one


@dataclass
class Samples:
    """Values (n,) at s (n,), or (n, m) at s and times t (m,)."""

    s: np.ndarray
    t: np.ndarray | None
    values: np.ndarray


def read_samples(path, columns=None) -> Samples:
    """Return the samples in a table; raises FileError.

    Two columns, or the two ``columns`` that are named: s and the values. More: the first row has
    the times, the first column s, and what stands in their corner does not count.
    """
    table = read_table(path, corner=columns is None)
    if columns is not None or table.width == 2:
        chosen = [0, 1] if columns is None else [find(table, name) for name in columns]
        s, values = table.floats(chosen).T
        t, rows = None, 0
    elif table.width < 2 or table.names:
        raise FileError(
            f"{path}: has {table.width} columns: over s it has two (or columns: [s, name]); "
            "over s and t its first row has the times"
        )
    else:
        whole = table.floats(list(range(table.width)))
        s, t, values, rows = whole[1:, 0], whole[0, 1:], whole[1:, 1:], 1
        if len(t) < 2 or not (np.diff(t) > 0.0).all():
            raise FileError(f"{path}: the times in its first row must increase")
    steps = np.diff(s)
    if len(s) < 2 or not (steps > 0.0).all():
        k = int(np.argmin(steps > 0.0)) + 1 + rows if len(s) > 1 else 0
        raise table.fault(min(k, len(table.rows) - 1), "s must increase from row to row")
    return Samples(s.copy(), t, values.copy())


def close_period(samples: Samples, period: float, path) -> Samples:
    """Return the samples of one period, without its end where that is its beginning again."""
    if samples.t is None:
        raise FileError(f"{path}: a table over s alone has no period")
    over = (samples.t[-1] - samples.t[0]) / period - 1.0
    if over > SAME:
        raise FileError(f"{path}: its times run over {1.0 + over:.6g} periods of {period:g}")
    if over < -SAME:
        return samples
    size = np.abs(samples.values).max()
    jump = np.abs(samples.values[:, -1] - samples.values[:, 0]).max()
    if jump > 0.01 * size:
        raise FileError(
            f"{path}: after one period of {period:g} its values differ by {jump:.3g} of {size:.3g}"
        )
    return Samples(samples.s, samples.t[:-1], samples.values[:, :-1])
