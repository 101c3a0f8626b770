"""A stored run as .vtkhdf, .csv or .npz: rods and their data, or tracers; or what opens it."""

from __future__ import annotations

import json
import math

import numpy as np

from rodsim.analysis.strain import at_points
from rodsim.analysis.wall import piece_of_wall
from rodsim.errors import FileError
from rodsim.export.paraview import write_state
from rodsim.export.polydata import write_polydata
from rodsim.export.tables import component_heads, head, write_csv, write_npz
from rodsim.output.layout import OF_BODIES
from rodsim.output.vtkhdf import rod_lines

SUFFIXES = (".vtkhdf", ".csv", ".npz", ".py")


def export_run(run, path, *, every=1, tracers=False, radius=None, progress=None) -> None:
    """Write every ``every``-th frame of an open run to a file whose suffix says the format.

    ``tracers``: the fluid markers instead of the rods (an .npz always has both). ``radius``: of
    the tubes in ParaView, a length; by default that of the cylinder that drags the fluid along
    as the rod does: ``epsilon e^(-1/2)``, or ``e^(-1)`` for algebraic9. A .py is a state of
    ParaView that opens the run itself, all frames. With the rods an .vtkhdf
    has the surfaces of bodies as triangles, and a piece of the wall, where there is one, as a
    polygon of four points more; their points have NaN for data. Raises FileError.
    """
    frames = range(0, run.frames, every)
    if not frames:
        raise FileError(f"{run.path}: has no frames yet ({run.status})")
    if tracers and "tracers" not in run.fields:
        raise FileError(f"{run.path}: has no tracers")
    if path.suffix == ".py":
        write_state(run, path, radius or tube_radius(run))
    elif path.suffix == ".npz":
        write_npz(path, _arrays(run, slice(None, None, every)))
    elif path.suffix == ".csv":
        heads = _heads(run, tracers)
        write_csv(path, heads, _blocks(run, frames, tracers), len(frames), progress)
    elif tracers:
        export_paths(path, run.time[list(frames)], _markers(run, frames), progress)
    else:
        radius, wall = radius or tube_radius(run), _wall(run, frames)
        wall_first = run.points + run.surfaces(0).shape[0]
        faces = (run.triangles + run.points).tolist()
        if len(wall):
            faces.append(list(range(wall_first, wall_first + len(wall))))
        cells = {"Lines": rod_lines(run.rods), **({"Polygons": faces} if faces else {})}
        moving = (
            _with(wall, *_with(run.surfaces(frame), *_frame(run, frame, radius)))
            for frame in frames
        )
        numbers = {"rod": np.array([*range(len(run.rods)), *[-1] * len(faces)])}
        write_polydata(path, run.time[list(frames)], moving, cells, numbers, progress)


def export_paths(path, time, paths, progress=None) -> None:
    """Write moving points, an iterable of (P, 3) for each time, as vertices; raises FileError."""
    first = next(paths := iter(paths))
    vertices = [[number] for number in range(len(first))]
    frames = ((position, {}) for position in (first, *paths))
    write_polydata(path, time, frames, {"Vertices": vertices}, progress=progress)


def tube_radius(run) -> float:
    """Return the radius of the cylinder that moves as a line of the run's blobs does."""
    from rodsim.scene.restore import restore_case, stored_diameter

    return 0.5 * stored_diameter(run, restore_case(run))


def _markers(run, frames):
    return (run.read("tracers", frame) for frame in frames)


def _frame(run, frame, radius):
    """Return positions and point data of a frame: s, radius, triads, curvature, stored fields."""
    data = {"s": _arc(run), "radius": np.full(run.points, radius)}
    for name in run.fields:
        if name == "director":
            triads = run.read(name, frame)
            data |= {f"D{i + 1}": triads[:, i] for i in range(3)}
            data["curvature"], data["twist"] = at_points(run.rods, triads)
        elif name not in ("position", "tracers"):
            data[name] = run.read(name, frame)
    return run.read("position", frame), data


def _wall(run, frames):
    """Return the corners (4, 3) of the wall under the rods of all frames, (0, 3) without one."""
    if run.wall is None:
        return np.zeros((0, 3))
    seen = (np.vstack([run.read("position", k), run.surfaces(k)]) for k in frames)
    ends = np.concatenate([(position.min(axis=0), position.max(axis=0)) for position in seen])
    return piece_of_wall(ends, run.wall, math.inf)


def _with(more, position, data):
    """Return positions and point data with those of more points, NaN, after them."""
    joined = {}
    for name, values in data.items():
        nothing = np.full((len(more), *values.shape[1:]), np.nan)
        joined[name] = np.concatenate([values, nothing])
    return np.concatenate([position, more]), joined


def _arc(run):
    return np.concatenate([np.arange(rod.count) * rod.spacing for rod in run.rods])


def _heads(run, tracers):
    time, length = head("time", run.units["time"]), run.units["length"]
    if tracers:
        return ["frame", time, "tracer", *component_heads("", length)]
    heads = ["frame", time, "rod", "point", head("s", length), *component_heads("", length)]
    for name in run.fields:
        if name == "director":
            heads += [h for i in (1, 2, 3) for h in component_heads(f"D{i}", "")]
        elif name not in ("position", "tracers"):
            heads += component_heads(name, run.unit(name))
    return heads


def _blocks(run, frames, tracers):
    """Yield the columns of each frame."""
    if not tracers:
        names = np.concatenate([[rod.name] * rod.count for rod in run.rods])
        numbers = np.concatenate([np.arange(rod.count) for rod in run.rods])
        fixed = [names, numbers, _arc(run)]
        fields = [name for name in run.fields if name != "tracers"]
    for frame in frames:
        if tracers:
            columns = [*run.read("tracers", frame).T]
            columns.insert(0, np.arange(len(columns[0])))
        else:
            values = [run.read(name, frame).reshape(run.points, -1).T for name in fields]
            columns = [*fixed, *(column for value in values for column in value)]
        rows = len(columns[0])
        yield [np.full(rows, frame), np.full(rows, run.time[frame]), *columns]


def _arrays(run, frames):
    """Return everything of some frames under its name, and what is needed to read it."""
    arrays = {"time": run.time[frames], "step": run.steps[frames]}
    arrays |= {name: run.read(name, frames) for name in run.fields}
    arrays |= {name: run.observable(name, frames) for name in run.observables}
    if run.bodies:
        arrays["body_name"] = np.array(run.bodies)
        arrays |= {f"body_{name}": run.of_bodies(name, frames) for name in OF_BODIES}
    rods = [rod.name for rod in run.rods]
    rows = {name: run.labels(name) for name in run.observables}
    if rows := {name: labels for name, labels in rows.items() if labels not in ([], rods)}:
        arrays["rows"] = json.dumps(rows)
    for key in ("name", "first", "count", "closed", "spacing", "moduli"):
        arrays[f"rod_{key}"] = np.array([getattr(rod, key) for rod in run.rods])
    units = {name: run.unit(name) for name in (*run.fields, *run.observables)}
    units["time"] = run.units["time"]
    return arrays | {"units": json.dumps(units), "case": run.case_resolved}
