"""How far rods, bodies and a wall are from the surfaces of bodies."""

from __future__ import annotations

import numpy as np

from rodsim.blocks.distance import distance, local
from rodsim.blocks.ends import end_node, held_ends
from rodsim.forces.places import rod_named


def check_bodies(case, scene) -> list:
    """Return problems of rods in bodies or attached from afar, and of bodies that overlap."""
    checks = (_inside, _apart, _below_wall, _far)
    return [problem for check in checks for problem in check(case, scene)]


def deepest_point(scene, state):
    """Return how far a rod's point lies inside a body, which point and body; 0 where none does."""
    deepest = 0.0, -1, None
    for body in scene.bodies:
        outside = _outside(scene, body, state)
        k = int(np.argmin(outside))
        if -outside[k] > deepest[0]:
            deepest = -float(outside[k]), k, body
    return deepest


def _outside(scene, body, state):
    """Return how far each point of a rod is outside a body, (N,).

    Held points are infinitely far: they are where they were put.
    """
    turn, centre = state.director[:, :, body.node].T, state.position[:, body.node]
    points = state.position[:, : scene.rods.points]
    outside = distance(body.shape, body.surface, local(turn, centre, points))
    held = [
        end_node(rod_named(scene.rods, name), key.removeprefix("held_"))
        for name, kept in scene.arrays.items()
        for key in kept
        if key.startswith("held_")
    ]
    outside[held] = np.inf
    return outside


def _inside(case, scene):
    """Yield a problem for each rod that starts with a point in a body."""
    for body in scene.bodies:
        outside = _outside(scene, body, scene.initial)
        for rod in scene.rods:
            k = int(np.argmin(outside[rod.nodes]))
            depth = -outside[rod.first + k]
            if depth > 0.0:
                reason = f"point {k} lies {depth:.3g} inside body '{body.name}': move or turn one"
                yield case.source.problem(("rods", rod.name, "shape"), reason)


def _far(case, scene):
    """Yield a problem for each end that is held by a body from afar."""
    for name, which, end in held_ends(case):
        if end.to == "space" or end.gap:
            continue
        body = next(body for body in scene.bodies if body.name == end.to)
        place = local(body.turn, body.centre, scene.arrays[name][f"held_{which}"][:3, None])
        far = abs(float(distance(body.shape, body.surface, place)[0]))
        if far > scene.epsilon * (1.0 + 1e-9):
            reason = (
                f"is {far:.4g} from the surface of '{end.to}', more than epsilon, "
                f"{scene.epsilon:.4g}: move it there, or say gap: true"
            )
            yield case.source.problem(("rods", name, which, "to"), reason)


def _apart(case, scene):
    """Yield a problem for each pair of bodies of which one has a point of the other inside.

    An overlap shallower than the points are apart can go unseen.
    """
    for i, body in enumerate(scene.bodies):
        for other in scene.bodies[:i]:
            pairs = (body, other), (other, body)
            depths = (
                distance(a.shape, a.surface, local(a.turn, a.centre, _skin(b))) for a, b in pairs
            )
            if min(float(d.min()) for d in depths) < 0.0:
                reason = f"overlaps body '{other.name}': move one"
                yield case.source.problem(("bodies", body.name, "shape"), reason)


def _below_wall(case, scene):
    """Yield a problem for each body that is not above the wall."""
    for body in scene.bodies if scene.wall is not None else ():
        lowest = float(_skin(body)[2].min())
        if lowest <= scene.wall:
            reason = f"is at z = {lowest:.6g}: must be above the wall, z = {scene.wall:g}"
            yield case.source.problem(("bodies", body.name, "shape"), reason)


def _skin(body):
    """Return the surface of a body where it starts, (3, n)."""
    return body.centre[:, None] + body.turn @ body.surface.skin
