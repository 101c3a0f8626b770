"""What ``rodsim info`` says of the rods as they start: distances, tilt, elastic energy."""

from __future__ import annotations

import numpy as np

from rodsim.forces.elastic import ENERGIES
from rodsim.scene.geometry import Geometry
from rodsim.units import unit_text


def describe_start(scene, system, units) -> list[str]:
    """Return two lines for each rod; ``units``: names of length, mass and time."""
    rods, lines = scene.rods, []
    _, seen = system.observe(scene.initial, np.zeros((6, scene.nodes)))
    position, director = scene.initial.position, scene.initial.director
    for r, name in enumerate(rods.names):
        nodes = slice(int(rods.first[r]), int(rods.first[r] + rods.count[r]))
        closed, spacing = bool(rods.closed[r]), float(rods.spacing[r])
        start = Geometry(position[:, nodes], director[:, :, nodes], spacing, closed)
        distances, tilt = start.distances, np.degrees(start.tilt)
        lines.append(
            f"rod {name} at t = 0: points {distances.min():.6g} to {distances.max():.6g} spacings "
            f"apart, {distances.mean():.6g} in the mean; D3 up to {tilt.max():.3g} degrees from "
            "the chords"
        )
        values = {key: float(np.ravel(seen[key])[r]) for key in ENERGIES}
        parts = ", ".join(
            f"{key.removesuffix('_energy')} {value:.4g}" for key, value in values.items()
        )
        unit = unit_text((1, 2, -2), units)
        lines.append(f"rod {name} at t = 0: energy {sum(values.values()):.4g} {unit}: {parts}")
    return lines
