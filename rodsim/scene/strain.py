"""Strain twist that needs more than its text: the rod's own, and tables over s or s and t."""

import numpy as np

from rodsim.case.expressions import Expression
from rodsim.case.strain import TABLES
from rodsim.errors import FileError
from rodsim.forces.strain import strains
from rodsim.scene.data.functions import Samples, close_period, read_samples
from rodsim.scene.spline import Spline
from rodsim.scene.stored import find_file


class NaturalEntry:
    """An expression in s, t and the rod's own strain twist natural_1..3, as f(s, t)."""

    def __init__(self, expression: Expression, natural: np.ndarray, spacing: float):
        self._expression, self._natural, self._spacing = expression, natural, spacing
        self.uses_t = expression.uses_t

    def __call__(self, s, t):
        """Return the values at the middles of segments, s (n,), at times that broadcast with it."""
        k = np.rint(np.asarray(s) / self._spacing - 0.5).astype(int)
        return self._expression(s, t, *self._natural[k].T)


class TableEntry:
    """Samples over s, or s and t, as f(s, t): cubic splines, periodic in t where a period is."""

    def __init__(self, samples: Samples, period: float | None):
        self.samples, self._period = samples, period
        self._along = {}
        self.uses_t = samples.t is not None

    def __call__(self, s, t):
        """Return the values at s (n,) and times (m, 1) or one time."""
        s, t = np.asarray(s, float), np.asarray(t, float)
        along = self._at(s)
        if not self.uses_t:
            return np.broadcast_to(along, np.broadcast_shapes(s.shape, t.shape)).copy()
        values = along(t.reshape(-1))
        return values.reshape(*np.broadcast_shapes(s.shape, t.shape))

    def _at(self, s):
        """Return the values at s, or their spline in t; kept, the same s come again and again."""
        key = s.tobytes()
        if key not in self._along:
            values = Spline(self.samples.s, self.samples.values)(s)
            if self.uses_t:
                values = Spline(self.samples.t, np.moveaxis(values, -1, 0), self._period)
            self._along[key] = values
        return self._along[key]


def bind(rod, built, folder, kept=None):
    """Return the three entries of a rod's strain twist, and the arrays to keep of its making.

    ``built``: the rod as built; ``kept``: the arrays of an earlier run, which then are taken for
    it. Raises FileError for a table.
    """
    arrays, entries = {}, []
    if rod.uses_natural:
        natural = None if kept is None else kept.get("natural")
        if natural is None:
            natural = strains(
                built.position.T, built.director.transpose(2, 0, 1), built.spacing, built.closed
            )
        if natural.shape[1:] != (6,):
            raise FileError(f"its strain twist at t = 0 has shape {natural.shape}")
        arrays["natural"] = natural
    for i, entry in enumerate(rod.entries, start=1):
        if isinstance(entry, TABLES):
            samples = _samples(entry, folder, kept, f"strain_twist_{i}")
            arrays |= _arrays(samples, f"strain_twist_{i}")
            entries.append(TableEntry(samples, entry.period))
        elif isinstance(entry, Expression) and entry.uses_natural:
            entries.append(NaturalEntry(entry, arrays["natural"][:, :3], built.spacing))
        else:
            entries.append(entry)
    return tuple(entries), arrays


def check_reach(rod, entries, spacing, segments, end):
    """Yield (path, reason) of tables that do not reach over the rod and the run."""
    first, last = 0.5 * spacing, (segments - 0.5) * spacing
    for i, (entry, given) in enumerate(zip(entries, rod.entries, strict=True)):
        if not isinstance(entry, TableEntry):
            continue
        key = ("strain_twist", i) if given.component is None else ("strain_twist", "table")
        s, t = entry.samples.s, entry.samples.t
        low, high = s[0] - 0.5 * (s[1] - s[0]), s[-1] + 0.5 * (s[-1] - s[-2])
        if low > first or high < last:
            reach = f"its s go from {s[0]:.6g} to {s[-1]:.6g}"
            needs = f"the rod's segments from {first:.6g} to {last:.6g}"
            yield key, f"{reach}, {needs}"
        if t is not None and given.period is None and (t[0] > 0.0 or t[-1] < end):
            reach = f"its times go from {t[0]:.6g} to {t[-1]:.6g}, the run from 0 to {end:.6g}"
            yield key, f"{reach}: give period: where it repeats itself"


def _samples(entry, folder, kept, name):
    if kept is not None and f"{name}_s" in kept:
        return Samples(kept[f"{name}_s"], kept.get(f"{name}_t"), kept[f"{name}_values"])
    path = find_file(entry.table, folder)
    samples = read_samples(path, entry.columns, entry.component)
    return samples if entry.period is None else close_period(samples, entry.period, path)


def _arrays(samples, name):
    arrays = {f"{name}_s": samples.s, f"{name}_values": samples.values}
    return arrays if samples.t is None else arrays | {f"{name}_t": samples.t}
