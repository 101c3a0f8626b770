"""The energies of a run over time, summed over its rods."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from rodsim.errors import FileError
from rodsim.output import open_trajectory
from rodsim.units import thermal_energy

PARTS = ("bending", "twisting", "shear", "stretch")
BESIDE = {"kinetic": "kinetic_energy", "work": "external_work", "dissipated": "dissipated"}


@dataclass(frozen=True)
class EnergyTable:
    """Rows of numbers with named, unit-bearing columns.

    time; what is stored in the rods, and in tethers where there are any; total, the sum of that;
    kinetic where there is a density; work from outside and dissipated, both since t = 0, where
    anything acts from outside: then total + dissipated - work stays what it was, to O(ds^2).
    of_each : where there are several rods, tethers or hooks, the energies of each, ``left.bending``
    or ``rope.tether``: (T,).
    """

    columns: tuple[str, ...]
    unit: str
    time_unit: str
    rows: np.ndarray
    of_each: dict[str, np.ndarray] = field(default_factory=dict)

    def text(self) -> str:
        """Return the table as aligned text."""
        lines = [f"energies in {self.unit}, time in {self.time_unit}"]
        lines.append("  ".join(f"{name:>13}" for name in self.columns))
        lines += ["  ".join(f"{value:13.6e}" for value in row) for row in self.rows]
        return "\n".join(lines)

    def write_csv(self, path) -> None:
        """Write the table with full precision, also of each rod and tether; raises FileError."""
        from rodsim.export.tables import write_csv

        columns = [*np.transpose(self.rows), *self.of_each.values()]
        write_csv(path, self._heads(), [columns])

    def _heads(self):
        names = (*self.columns, *self.of_each)
        return [f"{c} ({self.time_unit if c == 'time' else self.unit})" for c in names]


def energy_table(path, kelvin: float | None = None) -> EnergyTable:
    """Return the energies of an output file, in its own unit or in kT at ``kelvin``.

    1 kT at 298 K is 4.114e-6 g um^2 s^-2. Raises FileError, or UsageError where the case's units
    are not ones that kT can be converted to.
    """
    with open_trajectory(path) as run:
        if run.frames == 0:
            raise FileError(f"{path}: has no frames yet ({run.status})")
        stored = {name.removesuffix("_energy"): _summed(run, name) for name in _stored(run)}
        series = {"time": run.time, **stored, "total": np.sum([*stored.values()], axis=0)}
        for column, name in BESIDE.items():
            if name in run.observables:
                series[column] = _summed(run, name)
        of_each = (_of_rods(run) if len(run.rods) > 1 else {}) | _of_others(run)
        unit, units = run.unit("bending_energy"), run.units
    rows = np.array([*series.values()]).T
    if kelvin is not None:
        thermal = thermal_energy(kelvin, units)
        rows[:, 1:] /= thermal
        of_each = {name: values / thermal for name, values in of_each.items()}
        unit = f"kT at {kelvin:g} K"
    return EnergyTable(tuple(series), unit, units["time"], rows, of_each)


def _of_rods(run):
    """Return the elastic energies of each rod, and its kinetic one where it is stored."""
    stored = [(name, f"{name}_energy") for name in (*PARTS, "kinetic")]
    found = [(name, run.observable(o)) for name, o in stored if o in run.observables]
    rods = [(k, rod.name) for k, rod in enumerate(run.rods)]
    return {f"{rod}.{name}": values[:, k] for k, rod in rods for name, values in found}


def _of_others(run):
    """Return the energies of each tether and hook, by names such as ``rope.tether``."""
    found = {}
    for name in _stored(run)[len(PARTS) :]:
        labels, values = run.labels(name), run.observable(name)
        if len(labels) > 1:
            part = name.removesuffix("_energy")
            found |= {f"{of}.{part}": values[:, k] for k, of in enumerate(labels)}
    return found


def _stored(run):
    """Return the names of all energies that a scene stores: elastic first."""
    elastic = [f"{part}_energy" for part in PARTS]
    others = (name for name in run.observables if name.endswith("_energy"))
    return [*elastic, *(n for n in others if n not in (*elastic, BESIDE["kinetic"]))]


def _summed(run, name):
    values = run.observable(name)
    return values.reshape(len(values), -1).sum(axis=1)
