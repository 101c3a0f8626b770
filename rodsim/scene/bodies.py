"""The bodies of a case and the held ends of its rods: where they are at t = 0.

A body is a node after those of the rods: its centre, and its axes as a triad. So is the rotor of a
motor that winds up a hook.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rodsim.blocks.ends import end_node, held_ends, winds_up
from rodsim.blocks.hull import triangles
from rodsim.blocks.mobility import resistance_of
from rodsim.blocks.surface import SurfacePoints, surface_from, surface_of
from rodsim.errors import FileError
from rodsim.output import layout
from rodsim.scene.data.points import read_points
from rodsim.scene.quaternions import to_matrix, to_quaternion
from rodsim.scene.shapes import rotation_matrix
from rodsim.scene.stored import find_file, in_unit


@dataclass(frozen=True)
class Body:
    """A rigid body. centre (3,), turn (3, 3): of its frame at t = 0; shape: of the case.

    resistance (6, 6): drag and torque of its motions in free fluid. read (n, 3): the points of a
    surface from a file, as they are there.
    """

    name: str
    node: int
    shape: object
    surface: SurfacePoints
    centre: np.ndarray
    turn: np.ndarray
    resistance: np.ndarray
    read: np.ndarray | None = None

    def stored(self) -> dict:
        """Return what never changes of it, for the output; points and normals (n, 3).

        skin (n, 3) : points of the surface itself; triangles (F, 3) : between them.
        """
        surface, kept = self.surface, {}
        if surface.normals is not None:
            kept["normals"] = surface.normals.T.copy()
        if self.read is not None:
            kept["points_read"] = self.read
        return {
            "points": surface.points.T.copy(),
            "skin": surface.skin.T.copy(),
            "triangles": triangles(surface),
            "epsilon": surface.epsilon,
            "inset": surface.inset,
            "resistance": self.resistance,
            **kept,
        }


def build_bodies(case, points: int, blob: str, stored=None) -> tuple[Body, ...]:
    """Return the bodies of a case, nodes from ``points`` on; raises FileError.

    ``stored``: an earlier run, which knows the points of surfaces from files.
    """
    folder = Path(case.source.path).parent if case.source and case.source.path else Path()
    found = []
    for index, (name, body) in enumerate((case.bodies or {}).items()):
        try:
            kept = None if stored is None else stored.surface(name)
            surface, centre, turn, read = _build(body.shape, blob, folder, case.units.length, kept)
        except FileError as error:
            where = case.source.problem(("bodies", name, "shape", "path"), str(error))
            raise FileError(str(where)) from error
        drag = resistance_of(surface.points, blob, surface.epsilon, case.fluid.viscosity)
        found.append(Body(name, points + index, body.shape, surface, centre, turn, drag, read))
    return tuple(found)


def _build(shape, blob, folder, unit, kept):
    """Return a surface in its own frame, that of a file about the mean of its points.

    ``kept``: the points (n, 3) that an earlier run has read, as the file has them.
    """
    centre, turn = np.asarray(shape.origin, dtype=float), np.eye(3)
    if shape.rotate is not None:
        turn = rotation_matrix(shape.rotate.axis, np.radians(shape.rotate.degrees))
    if shape.kind != "file":
        return surface_of(shape, blob), centre, turn, None
    read = _read(shape, folder, unit) if kept is None else kept
    middle = read.mean(axis=0)
    return surface_from(read.T - middle[:, None], blob), centre + turn @ middle, turn, read


def _read(shape, folder, unit):
    found = read_points(find_file(shape.path, folder), False, shape.columns)
    factor, errors, _ = in_unit(shape.unit or found.unit, unit)
    if errors:
        raise FileError(errors[0][1])
    return factor * found.position


def start_of(position, director, node) -> np.ndarray:
    """Return place and triad of a node as one row of 12 numbers, for the output."""
    return np.append(position[:, node], director[:, :, node].ravel())


def add_nodes(case, rods, bodies, position, director, arrays):
    """Return positions and triads of all nodes, held ends where their holders have them at t = 0.

    ``arrays``: by rod; gets the place of each held end as it is built, unless it is of a stored
    run and there already.
    """
    position, director = position.copy(), director.copy()
    rotors = []
    for name, which, end in held_ends(case):
        node = end_node(rods[rods.names.index(name)], which)
        kept = arrays.setdefault(name, {})
        start = kept.setdefault(f"held_{which}", start_of(position, director, node))
        place, triad = start[:3], start[3:].reshape(3, 3)
        if end.move is not None:
            theta = np.array([_at_start(value) for value in end.move.turn])
            angle = float(np.linalg.norm(theta))
            place = place + [_at_start(value) for value in end.move.displace]
            triad = triad @ rotation_matrix(theta, angle).T if angle else triad
        position[:, node], director[:, :, node] = place, triad
        if winds_up(end):
            rotors.append((place, triad))
    places = [body.centre for body in bodies] + [place for place, _ in rotors]
    triads = [body.turn.T for body in bodies] + [triad for _, triad in rotors]
    if not places:
        return position, director
    return (
        np.ascontiguousarray(np.hstack([position, np.array(places).T])),
        np.ascontiguousarray(np.concatenate([director, np.array(triads).transpose(1, 2, 0)], 2)),
    )


def _at_start(value) -> float:
    return float(value(0.0, 0.0)) if callable(value) else float(value)


def nodes_series(scene) -> list:
    """Return the series of nodes that are no points of rods: (name, shape, dimension, place)."""
    bodies, rotors = len(scene.bodies), scene.nodes - scene.rods.points - len(scene.bodies)
    widths = {"position": 3, "orientation": 4, "velocity": 3, "angular_velocity": 3}
    series = [
        (f"body_{name}", (bodies, widths[name]), dimension, f"{layout.BODIES}/{name}")
        for name, dimension in layout.OF_BODIES.items()
        if bodies
    ]
    if skin := sum(body.surface.skin.shape[1] for body in scene.bodies):
        series.append(("surfaces", (skin, 3), layout.LENGTH, layout.SURFACES))
    if rotors:
        series.append(("rotor_place", (rotors, 7), (0, 0, 0), f"{layout.ROTORS}/place"))
    return series


def observe_nodes(scene, state, rates) -> dict:
    """Return the same of a state; ``rates`` (6, N): u and w of all nodes."""
    begin, middle = scene.rods.points, scene.rods.points + len(scene.bodies)
    turns = [to_quaternion(state.director[:, :, k].T) for k in range(begin, scene.nodes)]
    found = {}
    if middle > begin:
        found = {
            "body_position": state.position[:, begin:middle].T,
            "body_orientation": np.array(turns[: middle - begin]),
            "body_velocity": rates[:3, begin:middle].T,
            "body_angular_velocity": rates[3:, begin:middle].T,
            "surfaces": np.vstack([
                state.position[:, body.node] + body.surface.skin.T @ state.director[:, :, body.node]
                for body in scene.bodies
            ]),
        }  # fmt: skip
    if scene.nodes > middle:
        places = state.position[:, middle:].T
        found["rotor_place"] = np.hstack([places, np.array(turns[middle - begin :])])
    return found


def stored_nodes(run, frame: int):
    """Return positions (3, k) and triads (3, 3, k) of the nodes beyond the rods in a frame."""
    rows = run.of_rotors(frame)
    if run.bodies:
        bodies = (run.of_bodies(name, frame) for name in ("position", "orientation"))
        rows = np.vstack([np.hstack(list(bodies)), rows])
    triads = [to_matrix(row[3:]).T for row in rows]
    return rows[:, :3].T, np.array(triads).reshape(-1, 3, 3).transpose(1, 2, 0)


def check_bodies(case, scene) -> list:
    """Return problems of rods in bodies or attached from afar, and of bodies that overlap."""
    problems = []
    held = {(name, end_node(scene.rods[scene.rods.names.index(name)], which))
            for name, which, _ in held_ends(case)}  # fmt: skip
    for body in scene.bodies:
        for rod in scene.rods:
            points = _local(body, scene.initial.position[:, rod.nodes])
            outside = distance(body.shape, body.surface, points)
            for node in (n for r, n in held if r == rod.name):
                outside[node - rod.first] = np.inf
            k = int(np.argmin(outside))
            if outside[k] < 0.0:
                reason = (
                    f"point {k} lies {-outside[k]:.3g} inside body '{body.name}': move or turn one"
                )
                problems.append(case.source.problem(("rods", rod.name, "shape"), reason))
    problems += [*_apart(case, scene), *_below_wall(case, scene)]
    for name, which, end in held_ends(case):
        if end.to == "space" or end.gap:
            continue
        body = next(body for body in scene.bodies if body.name == end.to)
        rod = scene.rods[scene.rods.names.index(name)]
        place = scene.arrays[name][f"held_{which}"][:3, None]
        far = abs(float(distance(body.shape, body.surface, _local(body, place))[0]))
        if far > scene.epsilon * (1.0 + 1e-9):
            reason = (
                f"is {far:.4g} from the surface of '{end.to}', more than epsilon, "
                f"{scene.epsilon:.4g}: move it there, or say gap: true"
            )
            problems.append(case.source.problem(("rods", rod.name, which, "to"), reason))
    return problems


def _apart(case, scene):
    """Yield a problem for each pair of bodies of which one has a point of the other inside."""
    for i, body in enumerate(scene.bodies):
        for other in scene.bodies[:i]:
            pairs = (body, other), (other, body)
            depths = (
                distance(a.shape, a.surface, _local(a, b.centre[:, None] + b.turn @ b.surface.skin))
                for a, b in pairs
            )
            if min(float(d.min()) for d in depths) < 0.0:
                reason = f"overlaps body '{other.name}': move one"
                yield case.source.problem(("bodies", body.name, "shape"), reason)


def _below_wall(case, scene):
    """Yield a problem for each body that is not above the wall."""
    for body in scene.bodies if scene.wall is not None else ():
        lowest = float((body.centre[:, None] + body.turn @ body.surface.skin)[2].min())
        if lowest <= scene.wall:
            reason = f"is at z = {lowest:.6g}: must be above the wall, z = {scene.wall:g}"
            yield case.source.problem(("bodies", body.name, "shape"), reason)


def deepest_point(scene, state):
    """Return how far a rod's point lies inside a body, which point and body; 0 where none does.

    Held points do not count: they are where they were put.
    """
    deepest, held = (0.0, -1, None), _held_nodes(scene)
    for body in scene.bodies:
        turn, centre = state.director[:, :, body.node].T, state.position[:, body.node]
        points = turn.T @ (state.position[:, : scene.rods.points] - centre[:, None])
        inside = -distance(body.shape, body.surface, points)
        inside[held] = 0.0
        k = int(np.argmax(inside))
        if inside[k] > deepest[0]:
            deepest = float(inside[k]), k, body
    return deepest


def _held_nodes(scene):
    return [
        end_node(scene.rods[scene.rods.names.index(name)], key.removeprefix("held_"))
        for name, kept in scene.arrays.items()
        for key in kept
        if key.startswith("held_")
    ]


def _local(body, points):
    return body.turn.T @ (points - body.centre[:, None])


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
