"""The group ``/VTKHDF``: a view that lets ParaView open the output file itself, without a copy.

Format: VTKHDF 2.0, PolyData with steps. Points and point data are virtual datasets over the
trajectory; the lines, one per rod, and the triangles of bodies are shared by all steps. ``NSteps``
says how many frames there are. VTK's reader copies all of ``Steps/Values`` into room for
``NSteps``: values beyond that crash it, values missing are read as time 0. So each frame raises
``NSteps`` first, then adds its time.
"""

from __future__ import annotations

import h5py
import numpy as np

from rodsim.output.layout import SURFACES, TRAJECTORY, Plan
from rodsim.output.rows import Counter, Growing, put_whole

VERSION = (2, 0)
CELLS = ("Vertices", "Lines", "Polygons", "Strips")  # VTK insists on all four


def build_view(file: h5py.File, plan: Plan) -> None:
    """Create ``/VTKHDF`` with no frame visible yet."""
    root = file.create_group("VTKHDF")
    root.attrs["Version"] = np.array(VERSION, dtype=np.int64)
    root.attrs["Type"] = np.bytes_("PolyData")
    faces = plan.triangles
    surfaces = [file[f"{SURFACES}/value"]] if faces else []
    points = plan.points + sum(value.shape[1] for value in surfaces)
    root["NumberOfPoints"] = np.array([points], dtype=np.int64)
    add_cells(root, {"Lines": rod_lines(plan.rods), "Polygons": faces})
    rods = np.append(np.arange(len(plan.rods)), np.full(len(faces), -1))
    root["CellData/rod"] = rods.astype(np.int64)
    data = root.create_group("PointData")
    for series in plan.fields_stored():
        value = file.get(f"{series.where}/value")
        if series.name == "position":
            _add_view(
                root, "Points", points, [(value, np.s_[:]), *((s, np.s_[:]) for s in surfaces)]
            )
        elif series.name == "director":
            for i in range(3):
                _add_view(data, f"D{i + 1}", points, [(value, np.s_[:, :, i, :])])
        elif series.where.startswith(TRAJECTORY):
            _add_view(data, series.name, points, [(value, np.s_[:])])
    add_steps(root.create_group("Steps"), len(plan.times), points, data, ["rod"])


class View:
    """Makes the frames of an open ``/VTKHDF`` visible, one by one."""

    def __init__(self, group: h5py.Group):
        self._file, self._values = group.file, group["Steps/Values"]
        self._times, self._steps = Growing(self._values), Counter(group["Steps"], "NSteps")

    def count(self, frames: int) -> None:
        """Set the number of frames; to be on the disk before the last one is shown."""
        self._steps.put(frames)

    def show(self, index: int, time: float) -> None:
        """Show frame ``index``, which is on the disk, or correct its time."""
        self._times.put(index, time)
        self._file.flush()

    def show_all(self, times: np.ndarray) -> None:
        """Show exactly these frames, wherever a kill has left the view."""
        shown = max(1, len(times))
        self._values.resize((min(shown, len(self._values)),))
        self.count(len(times))
        self._file.flush()
        self._values.resize((shown,))
        self._values[:] = times if len(times) else 0.0
        self._times = Growing(self._values)
        self._file.flush()


def _add_view(group, name, points, sources):
    """Show datasets (T, n, ...), and what is picked of them, one after another in each frame.

    ``points``: of a frame; where no source has them, there is NaN.
    """
    frames, first = sources[0][0].shape[0], 0
    view = h5py.VirtualLayout((frames * points, 3), np.float64)
    for value, pick in sources:
        source = h5py.VirtualSource(".", value.name, value.shape)  # "." is this very file
        count = value.shape[1]
        if count == points:
            view[:] = source[pick]
        else:  # of every frame the same block of rows
            rows = h5py.MultiBlockSlice(start=first, stride=points, count=frames, block=count)
            view[rows, :] = source[pick]
        first += count
    group.create_virtual_dataset(name, view, fillvalue=np.nan)


def rod_lines(rods) -> list[list[int]]:
    """Return the node numbers of one polyline per rod; a closed one ends where it began."""
    return [
        [*range(rod.first, rod.first + rod.count), *([rod.first] if rod.closed else [])]
        for rod in rods
    ]


def add_cells(root: h5py.Group, cells: dict[str, list[list[int]]]) -> None:
    """Add the groups of all kinds of cells; some kinds have cells, given by their nodes."""
    for name in CELLS:
        nodes = cells.get(name, [])
        group = root.create_group(name)
        connectivity = [node for cell in nodes for node in cell]
        put_whole(group, "NumberOfCells", [len(nodes)])
        put_whole(group, "NumberOfConnectivityIds", [len(connectivity)])
        put_whole(group, "Offsets", np.cumsum([0, *map(len, nodes)]))
        put_whole(group, "Connectivity", connectivity)


def add_steps(group: h5py.Group, frames: int, points: int, point_data, cell_data) -> None:
    """Add what says where each frame's points and data lie; none is visible yet."""
    group.attrs["NSteps"] = np.int64(0)
    # One chunk, there from the start: growing changes one number, and no index that could tear.
    group.create_dataset("Values", (1,), np.float64, maxshape=(frames,), chunks=(frames,))[:] = 0.0
    put_whole(group, "NumberOfParts", np.ones(frames))
    parts = put_whole(group, "PartOffsets", np.zeros(frames))
    offsets = put_whole(group, "PointOffsets", np.arange(frames) * points)
    group["ConnectivityIdOffsets"] = put_whole(group, "CellOffsets", np.zeros((frames, len(CELLS))))
    for name in cell_data:
        group[f"CellDataOffsets/{name}"] = parts
    for name in point_data:
        group[f"PointDataOffsets/{name}"] = offsets
    group.require_group("PointDataOffsets")
