"""Points that move, joined by lines or not, as VTKHDF PolyData with time, for ParaView."""

from __future__ import annotations

import h5py
import numpy as np

from rodsim.files import replacing
from rodsim.output.vtkhdf import VERSION, add_cells, add_steps
from rodsim.progress import Silent


def write_polydata(path, times, frames, cells, cell_data=None, progress=None) -> None:
    """Write moving points as a file of its own, frame by frame; raises FileError.

    times (T,). ``frames`` yields, for each time, positions (N, 3) and point data: name -> (N,) or
    (N, 3). ``cells``: by kind, ``Lines`` and others of VTK in its order, the nodes of each cell,
    the same at all times; ``cell_data``: name -> one number per cell.
    """
    progress = progress or Silent()
    with replacing(path) as temporary, h5py.File(temporary, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array(VERSION, dtype=np.int64)
        root.attrs["Type"] = np.bytes_("PolyData")
        add_cells(root, cells)
        for number, (position, data) in enumerate(frames):
            if number == 0:
                _create(root, len(times), position, data, cell_data or {})
            rows = slice(number * len(position), (number + 1) * len(position))
            root["Points"][rows] = position
            for name, values in data.items():
                root[f"PointData/{name}"][rows] = values
            progress.update((number + 1) / len(times), f"frame {number + 1} of {len(times)}")
        steps = root["Steps"]
        steps["Values"].resize((len(times),))
        steps["Values"][:] = times
        steps.attrs.modify("NSteps", np.int64(len(times)))


def _create(root, frames, position, data, cell_data):
    """Make room for all frames."""
    points = len(position)
    root["NumberOfPoints"] = np.array([points], dtype=np.int64)
    root.create_dataset("Points", (frames * points, 3), float)
    group = root.create_group("PointData")
    for name, values in data.items():
        group.create_dataset(name, (frames * points, *values.shape[1:]), float)
    add_steps(root.create_group("Steps"), frames, points, group, cell_data)
    for name, values in cell_data.items():
        root[f"CellData/{name}"] = values
