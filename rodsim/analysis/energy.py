"""The energies of a run over time, summed over its rods."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rodsim.errors import FileError
from rodsim.output import open_trajectory
from rodsim.units import thermal_energy

PARTS = ("bending", "twisting", "shear", "stretch")


@dataclass(frozen=True)
class EnergyTable:
    """Rows of numbers with named, unit-bearing columns: time, the parts, total, kinetic."""

    columns: tuple[str, ...]
    unit: str
    time_unit: str
    rows: np.ndarray

    def text(self) -> str:
        """Return the table as aligned text."""
        lines = [f"energies in {self.unit}, time in {self.time_unit}"]
        lines.append("  ".join(f"{name:>13}" for name in self.columns))
        lines += ["  ".join(f"{value:13.6e}" for value in row) for row in self.rows]
        return "\n".join(lines)

    def write_csv(self, path) -> None:
        """Write the table with full precision; raises FileError."""
        from rodsim.export.tables import write_csv

        write_csv(path, self._heads(), [[*np.transpose(self.rows)]])

    def _heads(self):
        return [f"{c} ({self.time_unit if c == 'time' else self.unit})" for c in self.columns]


def energy_table(path, kelvin: float | None = None) -> EnergyTable:
    """Return the energies of an output file, in its own unit or in kT at ``kelvin``.

    1 kT at 298 K is 4.114e-6 g um^2 s^-2. Raises FileError, or UsageError where the case's units
    are not ones that kT can be converted to.
    """
    with open_trajectory(path) as run:
        if run.frames == 0:
            raise FileError(f"{path}: has no frames yet ({run.status})")
        parts = [run.observable(f"{part}_energy").sum(axis=1) for part in PARTS]
        columns = ["time", *PARTS, "total"]
        series = [run.time, *parts, np.sum(parts, axis=0)]
        if "kinetic_energy" in run.observables:
            columns.append("kinetic")
            series.append(run.observable("kinetic_energy").sum(axis=1))
        unit, units = run.unit("bending_energy"), run.units
    rows = np.array(series).T
    if kelvin is not None:
        rows[:, 1:] /= thermal_energy(kelvin, units)
        unit = f"kT at {kelvin:g} K"
    return EnergyTable(tuple(columns), unit, units["time"], rows)
