"""The bodies of a case and the held ends of its rods: where they are at t = 0.

A body is a node after those of the rods: its centre, and its axes as a triad. So is the rotor of a
motor that winds up a hook.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rodsim.blocks.ends import end_node, held_ends, winds_up
from rodsim.blocks.hull import triangles
from rodsim.blocks.mobility import resistance_of
from rodsim.blocks.surface import SurfacePoints, surface_from, surface_of
from rodsim.errors import FileError
from rodsim.forces.places import rod_named
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
    folder = case.folder
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
        node = end_node(rod_named(rods, name), which)
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
