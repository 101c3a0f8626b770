"""What a sweep tells of states at rest, which have no time and no speed."""

from rodsim.analysis.energy import PARTS

ENERGY = (1, 2, -2)
RESTS = {  # column -> dimension
    "status": (0, 0, 0),
    **{f"{part}_energy": ENERGY for part in (*PARTS, "elastic", "total")},
    "writhe": (0, 0, 0),
    "linking_number": (0, 0, 0),
    "growing_modes": (0, 0, 0),
    "neutral_modes": (0, 0, 0),
    "residual": (0, 0, 0),
    "gap": (0, 1, 0),
    "wall_seconds": (0, 0, 0),
    "message": (0, 0, 0),
}
SHOWN_AT_REST = ("status", "total_energy", "writhe", "growing_modes", "wall_seconds")


def total_energy(output) -> float:
    """Return the sum of all energies that an output stores, at its last frame."""
    names = [n for n in output.observables if n.endswith("_energy") and n != "kinetic_energy"]
    return float(sum(output.observable(name, -1).sum() for name in names))
