"""A flow on its grid as .vti, .csv or .npz; the paths of tracers as .vtkhdf, .csv or .npz."""

from __future__ import annotations

import json

import numpy as np

from rodsim.export.image import write_image
from rodsim.export.run import export_paths
from rodsim.export.tables import component_heads, head, write_csv, write_npz

FLOW, TRACERS = (".vti", ".csv", ".npz"), (".vtkhdf", ".csv", ".npz")


def export_flow(flow, units: dict, path) -> None:
    """Write position, velocity and pressure at the points of a grid. Raises FileError.

    .npz: ``x``, ``y``, ``z``, ``velocity`` (nx, ny, nz, 3), ``pressure`` (nx, ny, nz), ``time``;
    .csv: one row per point; .vti: an image for ParaView.
    """
    grid, data = flow.grid, {"velocity": flow.velocity, "pressure": flow.pressure}
    length, mass, time = (units[key] for key in ("length", "mass", "time"))
    names = {"velocity": f"{length} {time}^-1", "pressure": f"{mass} {length}^-1 {time}^-2"}
    if path.suffix == ".vti":
        write_image(path, grid.origin, grid.step, grid.shape, data)
    elif path.suffix == ".npz":
        cubes = {name: v.reshape(*grid.shape, *v.shape[1:]) for name, v in data.items()}
        names |= {"x": length, "y": length, "z": length, "time": time}
        coordinates = {"x": grid.x, "y": grid.y, "z": grid.z, "time": flow.time}
        write_npz(path, coordinates | cubes | {"units": json.dumps(names)})
    else:
        heads = [*component_heads("", length), *component_heads("velocity", names["velocity"])]
        heads.append(head("pressure", names["pressure"]))
        write_csv(path, heads, [[*grid.points.T, *flow.velocity.T, flow.pressure]])


def export_tracers(time, paths, units: dict, path) -> None:
    """Write the paths (T, P, 3) of tracers over time (T,). Raises FileError."""
    if path.suffix == ".vtkhdf":
        export_paths(path, time, paths)
    elif path.suffix == ".npz":
        names = {"time": units["time"], "position": units["length"]}
        write_npz(path, {"time": time, "position": paths, "units": json.dumps(names)})
    else:
        heads = [head("time", units["time"]), "tracer", *component_heads("", units["length"])]
        numbers = np.arange(paths.shape[1])
        blocks = ([np.full(len(x), t), numbers, *x.T] for t, x in zip(time, paths, strict=True))
        write_csv(path, heads, blocks)
