"""Kirchhoff rods as a part of a scene; the formulas are in :mod:`rodsim.forces.elasticity`."""

import numpy as np

from rodsim.compiled.parts import FORCE, Part
from rodsim.compiled.row import Entry, Row
from rodsim.registry import Kind

ENERGIES = ("bending_energy", "twisting_energy", "shear_energy", "stretch_energy")


def strain_twist(entries, rods) -> Row:
    """Return the intrinsic strain twist (Omega_1, Omega_2, Omega_3) of all rods as a row (3 N).

    ``entries``: for each rod three numbers or expressions in s, t. Segment k of a rod lies at
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


def elastic_part(row: Row) -> Part:
    """Return the part of rods with an intrinsic strain twist."""
    kernel = "rodsim.forces.elasticity:elastic_loads"
    return Part("elastic", FORCE, kernel, row, drive="the strain twist", observe=_observe)


def _build(case, scene):
    entries = [case.rods[rod.name].strain_twist for rod in scene.rods]
    return [elastic_part(strain_twist(entries, scene.rods))]


def _observe(state, row, scene):
    """Return the energies (6) and the present length of each rod."""
    from rodsim.forces.elasticity import energies

    rods, omega = scene.rods, row(state.time).reshape(3, -1)
    split, length = np.empty((4, len(rods))), np.empty(len(rods))
    energies(state.position, state.director, omega, rods.tables, split, length)
    return {**dict(zip(ENERGIES, split, strict=True)), "length": length}


KIND = Kind(build=_build)
