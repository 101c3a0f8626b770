"""Kirchhoff rods as a part of a scene; the formulas are in :mod:`rodsim.forces.elasticity`."""

import numpy as np

from rodsim.compiled.parts import FORCE, Part, Statics
from rodsim.compiled.row import Entry, Row
from rodsim.registry import Kind

ENERGIES = ("bending_energy", "twisting_energy", "shear_energy", "stretch_energy")
MANY = 20_000  # points from which threads share out the loads


def strain_twist(entries, rods) -> Row:
    """Return the intrinsic strain twist (Omega_1, Omega_2, Omega_3) of all rods as a row (3 N).

    ``entries``: for each rod three numbers or functions of s, t. Segment k of a rod lies at
    s = (k + 1/2) ds; the segment that an open rod does not have stays 0.
    """
    return Row(
        3 * rods.points,
        [
            Entry(entry, rod.middles_at, i * rods.points + rod.first, rod.name)
            for rod, triple in zip(rods, entries, strict=True)
            for i, entry in enumerate(triple)
        ],
    )


def elastic_part(scene) -> Part:
    """Return the part of the rods of a scene."""
    along = scene.along
    kernel, fixed = ("elastic", np.zeros(0)) if along is None else ("varying", along.ravel())
    shared = "shared_" if scene.rods.points >= MANY else ""
    home = f"rodsim.forces.{shared}elasticity:{kernel}_loads"
    exact = Statics(exact=f"rodsim.forces.exact:exact_{kernel}_loads")
    row, drive = strain_twist(scene.entries, scene.rods), "the strain twist"
    return Part("elastic", FORCE, home, row, fixed, drive, observe=_observe, statics=exact)


def _observe(state, row, scene):
    """Return the energies (6) and the present length of each rod."""
    from rodsim.forces.elasticity import UNIFORM, energies

    rods, omega = scene.rods, row(state.time).reshape(3, -1)
    along = UNIFORM if scene.along is None else scene.along
    split, length = np.empty((4, len(rods))), np.empty(len(rods))
    energies(state.position, state.director, omega, rods.tables, along, split, length)
    return {**dict(zip(ENERGIES, split, strict=True)), "length": length}


KIND = Kind(build=lambda case, scene: [elastic_part(scene)])
