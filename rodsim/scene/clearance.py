"""How far rods, bodies and a wall are from the surfaces of bodies."""

from __future__ import annotations

import numpy as np

from rodsim.blocks.ends import end_node, held_ends
from rodsim.blocks.surface import SurfacePoints
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
    outside = distance(body.shape, body.surface, _local(turn, centre, points))
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
        place = _local(body.turn, body.centre, scene.arrays[name][f"held_{which}"][:3, None])
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
                distance(a.shape, a.surface, _local(a.turn, a.centre, _skin(b))) for a, b in pairs
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


def _local(turn, centre, points):
    """Return points (3, n) in the frame of a body."""
    return turn.T @ (points - centre[:, None])


def distance(shape, surface: SurfacePoints, points: np.ndarray) -> np.ndarray:
    """Return how far points (3, n), in the frame of a body, are outside its surface; < 0 inside.

    Exact for spheres and spherocylinders, to first order in the distance for spheroids. A surface
    from a file counts as seen from its centre: as far as the surface point nearest in direction.
    """
    x, y, z = points
    rho = np.hypot(x, y)
    if shape.kind == "sphere":
        return np.hypot(rho, z) - shape.radius
    if shape.kind == "spherocylinder":
        straight = 0.5 * shape.length - shape.radius
        return np.hypot(rho, z - np.clip(z, -straight, straight)) - shape.radius
    if shape.kind == "spheroid":
        a, b = 0.5 * shape.length, shape.radius
        level = (rho / b) ** 2 + (z / a) ** 2 - 1.0
        slope = 2.0 * np.hypot(rho / b**2, z / a**2)
        return np.where(slope > 0.0, level / np.where(slope > 0.0, slope, 1.0), -min(a, b))
    skin = surface.skin
    radius = np.linalg.norm(skin, axis=0)
    far = np.linalg.norm(points, axis=0)
    nearest = np.argmax((skin / radius).T @ points, axis=0)
    return far - radius[nearest]
