"""Names, shapes and dimensions in the output file: what the writer, reader and docs share.

T frames, N points of all rods one after another, R rods, P tracers. A dimension is the exponents
of (mass, length, time).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from rodsim.nodes import Rods

FILETYPE = "rodsim"
FORMAT = 1
STATUS = ("running", "finished", "stopped", "diverged")
TEXT_BYTES = 32  # texts that change have a fixed length: they are changed in place, never moved
MOST_RESUMES, RESUME_BYTES = 100, 160  # room for the history; the last entry is used again

TRAJECTORY = "particles/trajectory"
TRACERS = "particles/tracers/position"
OBSERVABLES = "observables"
BODIES, ROTORS = "particles/bodies", "particles/rotors"
SURFACES = "particles/surfaces/position"  # of all bodies, one after another: (T, S, 3)
CLOCK = f"{TRAJECTORY}/position"  # where time and step live; every other group links to them

TIME, LENGTH, FORCE, ENERGY = (0, 0, 1), (0, 1, 0), (1, 1, -2), (1, 2, -2)
FIELDS = {
    "position": LENGTH,
    "director": (0, 0, 0),
    "velocity": (0, 1, -1),
    "angular_velocity": (0, 0, -1),
    "force": FORCE,  # of a point on the fluid
    "torque": ENERGY,
}
PER_ROD = {
    "bending_energy": ENERGY,
    "twisting_energy": ENERGY,
    "shear_energy": ENERGY,
    "stretch_energy": ENERGY,
    "kinetic_energy": ENERGY,  # only where the case gives a density
    "power": (1, 2, -3),
    "length": LENGTH,
}
OF_BODIES = {
    "position": LENGTH,  # of the centre
    "orientation": (0, 0, 0),  # quaternion w, x, y, z
    "velocity": (0, 1, -1),
    "angular_velocity": (0, 0, -1),
}
BALANCES = {"net_force": FORCE, "net_torque": ENERGY}  # of all rods together: a vector

# Attributes of /runtime exist from the start, so that setting them never moves anything in the
# file; what is not known yet is NaN, -1 or an empty text, and left out by the reader.
UNKNOWN = {float: np.float64(np.nan), int: np.int64(-1), str: np.bytes_(b"")}
RUNTIME = {
    "wall_seconds": float,
    "compile_seconds": float,
    "solve_seconds": float,
    "sum_seconds": float,
    "elasticity_seconds": float,
    "output_seconds": float,
    "evaluations": int,
    "steps_accepted": int,
    "steps_rejected": int,
    "max_stages": int,
    "spectral_radius": float,
    "threads": int,
    "threading_layer": str,
}
# of /runtime too; files of older versions lack them
MACHINE = ("numba", "llvmlite", "numpy", "processor")
DEVICE = ("device", "numba_cuda")  # only of runs with sums on a GPU


@dataclass(frozen=True)
class CaseText:
    """What ``/case`` holds: source and resolved case as text, and the ``--set`` options.

    ``inputs`` : digests of the files that the case names, as JSON; "" where it names none.
    """

    source: str
    resolved: str
    overrides: list[str]
    inputs: str = ""


@dataclass(frozen=True)
class Series:
    """One quantity over time: where it is stored, the shape of one frame, its dimension."""

    name: str
    where: str
    shape: tuple[int, ...]
    dimension: tuple[int, int, int]


@dataclass(frozen=True)
class Plan:
    """All that is known of an output file before the run: its texts, its sizes, its times.

    times : (T,) of all frames to come. tracers : their number P. fields : names out of ``FIELDS``;
    position is always stored. units : names of the units of ``length``, ``mass`` and ``time``.
    density : whether kinetic energy is stored. checkpoint : the first state of the run, which all
    later ones are like: arrays and numbers by name. extra : observables that not every scene has,
    (name, shape, dimension) each, and a place in the file where that is not /observables. bodies :
    what never changes of rigid bodies, arrays and numbers by name, by the name of the body.
    labels : whose the rows of a series are, by its name.
    device : attributes of /runtime on the GPU of a run, if it has one.
    arrays : by rod, what its strain twist was made from beside the case's text, and where its held
    ends are at rest, by name.
    """

    case: CaseText
    rods: Rods
    times: np.ndarray
    tracers: int
    fields: tuple[str, ...]
    units: dict[str, str]
    density: bool
    checkpoint: dict
    extra: tuple = ()
    arrays: dict = field(default_factory=dict)
    bodies: dict = field(default_factory=dict)
    labels: dict = field(default_factory=dict)
    device: dict = field(default_factory=dict)

    @property
    def points(self) -> int:
        """Number N of points of all rods."""
        return self.rods.points

    @property
    def triangles(self) -> list[list[int]]:
        """Return the corners of all faces of bodies, points of the surfaces counted after N."""
        faces, first = [], self.points
        for kept in self.bodies.values():
            faces += (kept["triangles"] + first).tolist()
            first += len(kept["skin"])
        return faces

    def fields_stored(self) -> Iterator[Series]:
        """Yield what is stored of every point and tracer; the position always is."""
        for name, dimension in FIELDS.items():
            if name in self.fields or name == "position":
                shape = (self.points, 3, 3) if name == "director" else (self.points, 3)
                yield Series(name, f"{TRAJECTORY}/{name}", shape, dimension)
        if self.tracers:
            yield Series("tracers", TRACERS, (self.tracers, 3), LENGTH)

    def observables_stored(self) -> Iterator[Series]:
        """Yield what is stored of every rod, of all together, and of what only some scenes have."""
        for name, dimension in PER_ROD.items():
            if self.density or name != "kinetic_energy":
                yield Series(name, f"{OBSERVABLES}/{name}", (len(self.rods),), dimension)
        for name, dimension in BALANCES.items():
            yield Series(name, f"{OBSERVABLES}/{name}", (3,), dimension)
        yield from self.extra_stored()

    def extra_stored(self) -> Iterator[Series]:
        """Yield what only some scenes have, in the order of ``extra``."""
        for name, shape, dimension, *where in self.extra:
            yield Series(name, where[0] if where else f"{OBSERVABLES}/{name}", shape, dimension)

    def stored(self) -> list[Series]:
        """Return every series of the file."""
        return [*self.fields_stored(), *self.observables_stored()]

    def value_bytes(self) -> int:
        """Return the room that the values of all frames take."""
        return 8 * len(self.times) * sum(math.prod(series.shape) for series in self.stored())
