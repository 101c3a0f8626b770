"""Builds the whole output file, empty: every dataset with room for every frame.

Sizes are known from the case, so datasets are fixed and allocated early: a disk that is too small
shows at t = 0, and a kill can tear no index. Frames that are not there yet are NaN.
"""

import json
import os
import shutil
from datetime import UTC, datetime
from pathlib import Path

import h5py
import numpy as np

import rodsim
from rodsim.errors import FileError
from rodsim.output import layout
from rodsim.output.layout import BALANCES, CLOCK, FIELDS, PER_ROD, TRACERS, TRAJECTORY
from rodsim.output.vtkhdf import build_view
from rodsim.units import unit_text


def build_file(path: Path, case, rods, times, tracers, fields, units, density) -> None:
    """Create ``path`` (which must not exist) with the layout of the contract."""
    points = sum(rod.count for rod in rods)
    _check_room(path, len(times), points, tracers, fields, len(rods))
    with h5py.File(path, "x", locking=False) as file:
        _root(file)
        _case(file.create_group("case"), case, units)
        _rods(file.create_group("rods"), rods)
        _values(file, times, points, tracers, fields, units, len(rods), density)
        file.create_group("runtime")
        build_view(file, rods, len(times), fields)


def _check_room(path, frames, points, tracers, fields, rods):
    per_frame = sum(np.prod(layout.field_shape(name, points)) for name in fields) + 3 * tracers
    needed = 8.0 * frames * (float(per_frame) + len(PER_ROD) * rods + 8) + 2**20
    free = shutil.disk_usage(path.parent).free
    if needed > free:
        raise FileError(
            f"{path.parent}: the output needs {_size(needed)}, {_size(free)} are free: "
            "give a longer output.interval or fewer output.fields"
        )


def _size(count):
    for unit in ("B", "kB", "MB", "GB", "TB", "PB"):
        if count < 1000.0 or unit == "PB":
            return f"{count:.3g} {unit}"
        count /= 1000.0
    raise AssertionError


def _root(file):
    file.attrs["filetype"] = layout.FILETYPE
    file.attrs["format"] = layout.FORMAT
    file.attrs["creator"] = "rodsim"
    file.attrs["version"] = rodsim.__version__
    file.attrs["created"] = datetime.now(UTC).isoformat(timespec="seconds")
    file.attrs.create("status", np.bytes_("running"), dtype=f"S{layout.STATUS_BYTES}")
    file.create_dataset("committed", data=np.int64(0))


def _case(group, case, units):
    text = h5py.string_dtype()
    group.create_dataset("source", data=case.source, dtype=text)
    group.create_dataset("resolved", data=case.resolved, dtype=text)
    group.create_dataset("overrides", data=case.overrides, shape=(len(case.overrides),), dtype=text)
    group.create_dataset("resumes", shape=(0,), maxshape=(None,), dtype=text)
    group.attrs["units"] = json.dumps(units)


def _rods(group, rods):
    for index, rod in enumerate(rods):
        node = group.create_group(rod.name)
        a1, a2, a3, b1, b2, b3 = rod.moduli
        node.attrs.update(
            index=index, first=rod.first, count=rod.count, spacing=rod.spacing, closed=rod.closed
        )
        node.attrs.update(bending=[a1, a2], twisting=a3, shear=[b1, b2], stretch=b3)


def _values(file, times, points, tracers, fields, units, rods, density):
    frames = len(times)
    clock = file.create_group(CLOCK)
    clock["time"] = np.full(frames, np.nan)
    clock["time"].attrs["units"] = unit_text((0, 0, 1), units)
    clock["step"] = np.full(frames, -1, dtype=np.int64)

    def add(where, shape, dimension):
        group = file.require_group(where)
        value = preallocated(group, "value", (frames, *shape))
        value.attrs["units"] = unit_text(dimension, units)
        if where != CLOCK:
            group["time"], group["step"] = clock["time"], clock["step"]

    for name in fields:
        add(f"{TRAJECTORY}/{name}", layout.field_shape(name, points), FIELDS[name])
    if tracers:
        add(TRACERS, (tracers, 3), FIELDS["position"])
    for name, dimension in PER_ROD.items():
        if name != "kinetic_energy" or density:
            add(f"observables/{name}", (rods,), dimension)
    for name, dimension in BALANCES.items():
        add(f"observables/{name}", (3,), dimension)


def preallocated(group, name, shape):
    """Create a float64 dataset of fixed size, allocated at once and filled with NaN."""
    plist = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    plist.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    plist.set_fill_time(h5py.h5d.FILL_TIME_ALLOC)
    plist.set_fill_value(np.array(np.nan))
    space = h5py.h5s.create_simple(shape)
    h5py.h5d.create(group.id, name.encode(), h5py.h5t.IEEE_F64LE, space, plist)
    return group[name]


def reserve(path: Path) -> None:
    """Make the file system keep room for all of the file, where it can."""
    if hasattr(os, "posix_fallocate"):
        with open(path, "r+b") as stream:
            os.posix_fallocate(stream.fileno(), 0, path.stat().st_size)
