"""What is in contact must not get into each other: checked at the start and after every step."""

from __future__ import annotations

import numpy as np

from rodsim.compiled.parts import Apart, Guard
from rodsim.errors import CaseError, Problem
from rodsim.forces.near import pairs_within

PRESSED = 0.5  # diameters: nearer than that, what pushes soon grows no more
STEP = 0.25  # diameters that a point may move in a step: two then come nearer by half of one, less
# what all move together


def at_start(case, scene, apart: Apart, surfaces=None) -> list[Problem]:
    """Return warnings of what starts in contact; CaseError where it overlaps too much.

    surfaces : those of bodies, :class:`rodsim.forces.bodies.Surfaces`, or None.
    """
    errors, warnings = [], []
    found = _closest(scene, apart), _lowest(scene), _on_surface(scene, surfaces)
    for distance, name, words in filter(None, found):
        share = distance / apart.diameter
        path = "rods" if name in scene.rods.names else "bodies", name, "shape"
        reason = f"{words}, {share:.2g} contact diameters"
        if share < PRESSED:
            who = "bodies and rods" if surfaces else "rods"
            reason += (
                f": {who} cannot start inside each other; move them, or make contact.diameter "
            )
            reason += f"smaller than {distance / PRESSED:.3g}"
            errors.append(case.source.problem(path, reason))
        elif share < 1.0:
            reason += ": they start in contact, and push each other apart"
            warnings.append(case.source.problem(path, reason))
    if errors:
        raise CaseError(errors)
    return warnings


def _closest(scene, apart):
    """Return (distance, rod, words) of the two points nearest to each other, None beyond d."""
    excluded = apart.excluded if apart.itself else scene.rods.count
    position = scene.initial.position
    first, second, distance = pairs_within(position, scene.rods, excluded, apart.diameter)
    if not len(distance):
        return None
    least = int(np.argmin(distance))
    (name, i), (other, j) = (scene.rods.locate(int(k[least])) for k in (first, second))
    who = f"point {j}" if name == other else f"point {j} of rod '{other}'"
    return distance[least], name, f"point {i} is {distance[least]:.4g} from {who}"


def _lowest(scene):
    """Return the same of the point next to the wall, from its mirror image."""
    if scene.wall is None:
        return None
    height = scene.initial.position[2, : scene.rods.points] - scene.wall
    k = int(np.argmin(height))
    name, i = scene.rods.locate(k)
    return 2.0 * height[k], name, f"point {i} is {2.0 * height[k]:.4g} from its image in the wall"


def _on_surface(scene, surfaces):
    """Return the same of what is nearest to a surface of a body, or of a body to the wall."""
    if surfaces is None:
        return None
    distance, name, whose, what = surfaces.closest(scene.initial)
    return 2.0 * distance, name, f"{what} {2.0 * distance:.4g} from its image in {whose}"


def guard(case, scene, fixed: np.ndarray, surfaces=None) -> Guard:
    """Return what contact asks of a step; ``fixed``: the numbers of the pairs."""
    diameter, rods = fixed[0], scene.rods
    unit = case.units.length

    free = slice(None) if scene.wall is None else slice(2)  # where all may move together

    def share(shift, turn):
        moved = shift.copy()
        moved[free] -= moved[free].mean(axis=1, keepdims=True)
        if surfaces is None:
            return float(np.sqrt((moved * moved).sum(axis=0).max()) / (STEP * diameter))
        farthest = np.linalg.norm(moved, axis=0) + surfaces.turning(turn)
        return float(farthest.max() / (STEP * diameter))

    def breach(state):
        from rodsim.forces.repulsion import closest_within

        limit = PRESSED * diameter
        distance, first, second = closest_within(fixed, rods.tables, state.position, limit)
        if first >= 0:
            return _pressed(case, rods, distance, first, second, unit)
        z = state.position[2, : rods.points]
        if scene.wall is not None and 2.0 * (z.min() - scene.wall) < limit:
            name, k = rods.locate(int(z.argmin()))
            return _remedy(case, f"rod '{name}' is pressed into the wall at point {k}")
        if surfaces is not None and (what := surfaces.pressed(state, 0.5 * limit)):
            return _remedy(case, what)
        return None

    most = STEP * diameter
    beyond = f"a point moves farther than a quarter of the contact diameter, {most:.3g} {unit}"
    return Guard(share, beyond, breach)


def _pressed(case, rods, distance, first, second, unit):
    (name, i), (other, j) = rods.locate(first), rods.locate(second)
    at = f"points {i} and {j}, {distance:.3g} {unit} apart"
    if name == other:
        return _remedy(case, f"rod '{name}' presses through itself at {at}")
    return _remedy(case, f"rods '{name}' and '{other}' press through each other at {at}")


def _remedy(case, what):
    """Return what is wrong, the usual cause and what to do, and the change for it."""
    cause = "what presses is stronger than the contact: raise contact.strength"
    return what, cause, f"contact.strength={4.0 * case.contact.strength:g}"
