"""The group ``/VTKHDF``: a view that lets ParaView open the output file itself, without a copy.

Format: VTKHDF 2.0, PolyData with steps. Points and point data are virtual datasets over the
trajectory; the lines, one per rod, are shared by all steps. Frames become visible one by one:
``NSteps`` is raised after the frame is written, and ``Steps/Values`` grows after that, because
VTK's reader crashes on more values than steps.
"""

import h5py
import numpy as np

from rodsim.output.layout import TRAJECTORY

VERSION = (2, 0)
CELLS = ("Vertices", "Lines", "Polygons", "Strips")  # VTK insists on all four


def build_view(file, rods, frames: int, fields) -> None:
    """Create ``/VTKHDF`` with no step visible yet."""
    points = sum(rod.count for rod in rods)
    root = file.create_group("VTKHDF")
    root.attrs["Version"] = np.array(VERSION, dtype=np.int64)
    root.attrs.create("Type", np.bytes_("PolyData"), dtype="S8")
    root["NumberOfPoints"] = np.array([points], dtype=np.int64)
    _virtual(file, root, "Points", "position", (frames, points, 3), ...)
    for kind in CELLS:
        _cells(root.create_group(kind), rods if kind == "Lines" else [])
    data = root.create_group("PointData")
    cells = root.create_group("CellData")
    cells["rod"] = np.arange(len(rods), dtype=np.int64)
    for name in fields:
        if name == "director":
            for i in range(3):
                pick = np.s_[:, :, i, :]
                _virtual(file, data, f"D{i + 1}", name, (frames, points, 3, 3), pick)
        elif name != "position":
            _virtual(file, data, name, name, (frames, points, 3), ...)
    _steps(root.create_group("Steps"), frames, points, list(data), list(cells))


def show_frame(file, frame: int, time: float) -> None:
    """Make frames up to ``frame`` visible; they must be on their way to the disk already."""
    steps = file["VTKHDF/Steps"]
    steps.attrs.modify("NSteps", np.int64(frame + 1))
    file.flush()
    steps["Values"].resize((frame + 1,))
    steps["Values"][frame] = time


def _virtual(file, group, name, field, shape, pick):
    layout = h5py.VirtualLayout((shape[0] * shape[1], 3), "<f8")
    source = h5py.VirtualSource(".", f"/{TRAJECTORY}/{field}/value", shape)
    layout[:, :] = source[pick]
    group.create_virtual_dataset(name, layout, fillvalue=np.nan)


def _cells(group, rods):
    """One polyline per rod; a closed one ends where it began."""
    lines = [
        np.r_[rod.first : rod.first + rod.count, [rod.first] * bool(rod.closed)] for rod in rods
    ]
    connectivity = np.concatenate([np.zeros(0), *lines]).astype(np.int64)
    group["NumberOfCells"] = np.array([len(lines)], dtype=np.int64)
    group["NumberOfConnectivityIds"] = np.array([connectivity.size], dtype=np.int64)
    group["Offsets"] = np.cumsum([0, *map(len, lines)], dtype=np.int64)
    group["Connectivity"] = connectivity


def _steps(group, frames, points, point_data, cell_data):
    group.attrs["NSteps"] = np.int64(0)
    # One chunk: growing it never splits an index that a kill could tear.
    group.create_dataset("Values", (0,), "<f8", maxshape=(frames,), chunks=(frames,))
    zeros = np.zeros(frames, dtype=np.int64)
    group["PartOffsets"] = zeros
    group["NumberOfParts"] = zeros + 1
    group["PointOffsets"] = np.arange(frames, dtype=np.int64) * points
    group["CellOffsets"] = np.zeros((frames, len(CELLS)), dtype=np.int64)
    group["ConnectivityIdOffsets"] = np.zeros((frames, len(CELLS)), dtype=np.int64)
    offsets = group.create_group("PointDataOffsets")
    for name in point_data:
        offsets[name] = np.arange(frames, dtype=np.int64) * points
    offsets = group.create_group("CellDataOffsets")
    for name in cell_data:
        offsets[name] = zeros
