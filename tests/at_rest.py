"""Scenes whose states at rest, and their stability, theory knows."""

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from rodsim.case import case_from_mapping
from rodsim.compiled.parts import PartList
from rodsim.rest.descent import GREATEST, SAME, Descent, descend
from rodsim.rest.forces import Forces
from rodsim.rest.modes import modes_of
from rodsim.rest.solve import scales_of
from rodsim.scene.build import build_scene

A, R0 = 3.5e-3, 2.5  # bending modulus and radius of the rings


def case_of(shape, moduli, strain, epsilon=0.314, **more):
    """Return a case of one rod as plain data."""
    rod = {"shape": shape, "moduli": moduli, "strain_twist": strain}
    return {
        "fluid": {"viscosity": 1e-6, "epsilon": epsilon},
        "rods": {"rod": rod},
        "time": {"end": 0.3},
    } | more


def moduli_of(b=0.8, bending=A, twisting=A):
    return {"bending": bending, "twisting": twisting, "shear": b, "stretch": b}


def ring(points, strain, b=0.8, bending=A, twisting=A):
    """Return the scene of a circle."""
    shape = {"kind": "ring", "radius": R0, "points": points}
    data = case_of(shape, moduli_of(b, bending, twisting), strain)
    return build_scene(case_from_mapping(data))


def held(scene, numbers):
    """Return a scene in which some degrees of freedom c N + k stay as they are."""
    first = scene.parts[0]
    statics = replace(first.statics, holds=tuple(numbers))
    return replace(scene, parts=PartList([replace(first, statics=statics), *scene.parts[1:]]))


def ends(scene, *nodes):
    """Return the degrees of freedom of some nodes."""
    n = scene.rods.points
    return [c * n + k % n for c in range(6) for k in nodes]


def near_state(scene):
    """Return the state at rest of the exact gradient nearest to the start, stable or not."""
    exact, scales = Forces(scene), scales_of(scene)
    start = Descent(scene.initial, np.inf, GREATEST * scales.first)  # Newton: it is near
    found = descend(exact, start, scales, 200, SAME, lambda *_: None)
    assert not found.failure
    return found.state


def modes(scene, count=12):
    """Return the modes of that state."""
    return modes_of(Forces(scene), near_state(scene), scales_of(scene), count)


def threshold(make, low, high, count=12):
    """Return the parameter at which one more mode grows: where an eigenvalue is 0.

    ``make(u)`` returns a scene; at ``low`` nothing grows, at ``high`` something does. Of the
    eigenvalues as many as are neutral at ``low``, those next to 0, are left out.
    """
    neutral = modes(make(low), count).neutral

    def lowest(u):
        values = modes(make(u), count).values
        return np.sort(values[np.argsort(abs(values))[neutral:]])[0]

    assert lowest(low) > 0.0 > lowest(high)
    return brentq(lowest, low, high, xtol=1e-7)


def extrapolated(coarse, fine):
    """Return the limit of an error that falls as the square of the spacing, from two M, 2 M."""
    return (4.0 * fine - coarse) / 3.0
