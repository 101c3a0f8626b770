"""Runs of the shipped cases by both methods; one that is there already is not run again."""

import json
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np

from rodsim import load_case, open_trajectory, simulate
from rodsim.errors import FileError
from rodsim.units import thermal_energy

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
SPACING = np.pi / 40  # um, of the open rod and the rings
PARTS = ("bending", "twisting", "shear", "stretch")


@dataclass
class Workplace:
    """Where runs and pictures go, how long a gIB run may take, and whether to be quick."""

    folder: Path
    quick: bool
    gib_seconds: float

    def path(self, name):
        """Return the path of a picture or table."""
        return self.folder / name

    def run(self, name, config, *overrides):
        """Return the output of a case by rodsim, under a name of its own."""
        return self._once(name, config, overrides, simulate)

    def run_gib(self, name, config, *overrides):
        """Return the output of a case by the gIB method, as far as it gets in ``gib_seconds``."""
        from gib.march import simulate as simulate_gib

        return self._once(name, config, overrides, simulate_gib, max_seconds=self.gib_seconds)

    def _once(self, name, config, overrides, method, **options):
        output = self.folder / "runs" / f"{name}.h5"
        case = load_case(CONFIGS / f"{config}.yaml", overrides)
        if not _is_run_of(output, case):
            output.parent.mkdir(parents=True, exist_ok=True)
            click.echo(f"  running {name}", err=True)
            method(case, output, overwrite=True, **options)
        return output


def _is_run_of(output, case):
    try:
        with open_trajectory(output) as run:
            wanted = json.dumps(case.resolved(), indent=1)
            return run.case_resolved == wanted and run.status in ("finished", "stopped")
    except FileError:
        return False


@dataclass(frozen=True)
class Energies:
    """Energies in kT at 298 K over time in s: the four parts, their total, kinetic."""

    time: np.ndarray
    parts: dict
    total: np.ndarray
    kinetic: np.ndarray


def energies(output) -> Energies:
    """Read the energies of a run of one rod."""
    with open_trajectory(output) as run:
        unit = thermal_energy(298.0, run.units)
        parts = {part: run.observable(f"{part}_energy")[:, 0] / unit for part in PARTS}
        kinetic = run.observable("kinetic_energy")[:, 0] / unit
        return Energies(run.time, parts, sum(parts.values()), kinetic)


def nearest(curves: dict, target: Energies):
    """Return the epsilon whose total energy is nearest to ``target``'s, and all distances.

    Distance: root mean square over the target's times of the difference, relative to the initial
    energy.
    """
    distances = {}
    for epsilon, curve in curves.items():
        at_times = np.interp(target.time, curve.time, curve.total)
        difference = (at_times - target.total) / target.total[0]
        distances[epsilon] = float(np.sqrt(np.mean(difference**2)))
    return min(distances, key=distances.get), distances


def text_of(distances) -> str:
    """Return distances as text, in per cent of the initial energy."""
    return ", ".join(f"{100 * d:.1f} % at {epsilon}" for epsilon, d in distances.items())
