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


def read_samples(path, columns=None, component: int | None = None) -> Samples:
    """Return the samples in a table; raises FileError.

    columns : names or numbers of s and the value, or of s, t and the value: a row for each pair of
    s and t, in any order. Without them two columns are s and the value; of more, the first row has
    the times, the first column s, and what stands in their corner does not count.
    component : 0, 1, 2 of a table of all three: ``columns`` are those of s, t where there is one,
    and the three; by default all of a table of four, or five.
    """
    table = read_table(path, corner=columns is None and component is None)
    chosen = _chosen(table, columns, component)
    if chosen is None:
        return _grid(table)
    values = table.floats(chosen)
    if len(chosen) == 3:
        return _gathered(table, *values.T)
    s, value = values.T
    _check_increase(table, s, 0)
    return Samples(s.copy(), None, value.copy())


def _chosen(table, columns, component):
    """Return the columns of s, t where there is one, and the value; None for a grid."""
    found = None if columns is None else [find(table, name) for name in columns]
    if component is None:
        return [0, 1] if found is None and table.width == 2 else found
    if found is None:
        if table.width not in (4, 5):
            raise FileError(
                f"{table.path}: has {table.width} columns: all three components are four, s and "
                "Omega_1 to Omega_3, or five, s, t and those; else write columns: [s, k1, k2, k3]"
            )
        found = list(range(table.width))
    return [*found[:-3], found[component - 3]]


def _grid(table):
    """Return the samples of a table whose first row has the times and whose first column s."""
    if table.width < 2 or table.names:
        raise FileError(
            f"{table.path}: has {table.width} columns: over s it has two (or columns: [s, name]); "
            "over s and t its first row has the times"
        )
    whole = table.floats(list(range(table.width)))
    s, t, values = whole[1:, 0], whole[0, 1:], whole[1:, 1:]
    if len(t) < 2 or not (np.diff(t) > 0.0).all():
        raise FileError(f"{table.path}: the times in its first row must increase")
    _check_increase(table, s, 1)
    return Samples(s.copy(), t, values.copy())


def _gathered(table, s, t, value):
    """Return the samples of a table with a row for each pair of s and t."""
    (along, k), (times, j) = np.unique(s, return_inverse=True), np.unique(t, return_inverse=True)
    if len(along) < 2 or len(times) < 2:
        raise FileError(
            f"{table.path}: has {len(along)} s and {len(times)} times: needs two of each"
        )
    values, rows = (
        np.full((len(along), len(times)), np.nan),
        np.zeros((len(along), len(times)), int),
    )
    np.add.at(rows, (k, j), 1)
    if rows.max() > 1:
        at = int(np.argmax(rows[k, j] > 1))
        raise table.fault(at, f"s = {s[at]:g}, t = {t[at]:g} is there {rows[k[at], j[at]]} times")
    values[k, j] = value
    if not rows.all():
        i, m = np.argwhere(rows == 0)[0]
        raise FileError(f"{table.path}: has no row for s = {along[i]:g}, t = {times[m]:g}")
    return Samples(along, times, values)


def _check_increase(table, s, before):
    """Raise FileError where s does not increase from row to row; ``before``: rows above them."""
    if len(s) < 2 or not (np.diff(s) > 0.0).all():
        k = int(np.argmin(np.diff(s) > 0.0)) + 1 + before if len(s) > 1 else 0
        raise table.fault(min(k, len(table.rows) - 1), "s must increase from row to row")


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
