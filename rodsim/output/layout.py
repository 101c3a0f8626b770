"""Names, shapes and units of the output file: one table that writer, reader and docs share.

T frames, N points of all rods one after another, R rods, P tracers. Dimensions are exponents of
(mass, length, time).
"""

from dataclasses import dataclass

FILETYPE = "rodsim"
FORMAT = 1
STATUS_BYTES = 16  # fixed length: changed in place, never moved

FIELDS = {
    "position": (0, 1, 0),
    "director": (0, 0, 0),
    "velocity": (0, 1, -1),
    "angular_velocity": (0, 0, -1),
    "force": (1, 1, -2),
    "torque": (1, 2, -2),
}
ENERGY = (1, 2, -2)
PER_ROD = {
    "bending_energy": ENERGY,
    "twisting_energy": ENERGY,
    "shear_energy": ENERGY,
    "stretch_energy": ENERGY,
    "kinetic_energy": ENERGY,  # only where the case gives a density
    "power": (1, 2, -3),
    "length": (0, 1, 0),
}
BALANCES = {"net_force": (1, 1, -2), "net_torque": ENERGY}

TRAJECTORY = "particles/trajectory"
TRACERS = "particles/tracers/position"
CLOCK = f"{TRAJECTORY}/position"  # where time and step live; all other groups link to them


@dataclass(frozen=True)
class CaseText:
    """What ``/case`` holds: source and resolved case as text, and the ``--set`` options."""

    source: str
    resolved: str
    overrides: list[str]


@dataclass(frozen=True)
class RodRecord:
    """What ``/rods/<name>`` holds. moduli: a_1 a_2 a_3 b_1 b_2 b_3; spacing: unstressed."""

    name: str
    first: int
    count: int
    closed: bool
    spacing: float
    moduli: tuple[float, ...]


def field_shape(name: str, points: int) -> tuple[int, ...]:
    """Return the shape of one frame of a field: (N, 3), for the director (N, 3, 3)."""
    return (points, 3, 3) if name == "director" else (points, 3)
