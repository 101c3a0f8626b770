"""Builds the output file whole and empty: every dataset with room for every frame.

Sizes are known from the case, so datasets are fixed and allocated early: a disk that is too small
shows at t = 0, and a kill can tear no index. Frames that are not there yet are NaN.
"""

from __future__ import annotations

import errno
import os
import shutil
from datetime import UTC, datetime
from pathlib import Path

import h5py
import numpy as np

from rodsim.compiled.settings import machine
from rodsim.errors import FileError
from rodsim.output import layout, rows
from rodsim.output.checkpoint import allocate
from rodsim.output.h5md import describe
from rodsim.output.layout import CLOCK, Plan
from rodsim.output.vtkhdf import build_view
from rodsim.units import unit_text

# Beside the values: time, step and offsets of ParaView's view per frame, its lines per point,
# groups per rod, headers per file. Generous: what is not used is given back at the end.
FRAME_BYTES, POINT_BYTES, ROD_BYTES, FILE_BYTES = 130, 40, 3000, 2**17

abandoned = []  # files that could not be written: HDF5 can crash the process in closing them


def build_file(path: Path, plan: Plan) -> h5py.File:
    """Create ``path``, which must not exist, and return it open and complete.

    Raises FileError where it cannot fit or cannot be written; then no file is left.
    """
    needed = room(plan)
    free = shutil.disk_usage(path.parent).free
    if needed > free:
        raise FileError(
            f"the output needs {size(needed)}, {size(free)} are free: "
            "give a longer output.interval or fewer output.fields"
        )
    file = rows.open_to_write(path, new=True)
    try:
        _reserve(file, needed)
        _fill(file, plan)
    except BaseException as error:
        path.unlink(missing_ok=True)
        abandoned.append(file)
        if isinstance(error, RuntimeError):  # HDF5's own words for a failed write
            raise FileError(f"HDF5 could not write it: {error}") from error
        raise
    return file


def trim(file: h5py.File) -> None:
    """Give back what was reserved and is not used."""
    file.flush()
    os.ftruncate(rows.descriptor(file), file.id.get_filesize())


def room(plan: Plan) -> int:
    """Return the bytes that an output file takes while it is written, or a little more."""
    texts = (plan.case.source, plan.case.resolved, plan.case.inputs, *plan.case.overrides)
    count = plan.value_bytes() + FRAME_BYTES * len(plan.times) + 4 * sum(map(len, texts))
    count += 2 * sum(np.asarray(value).nbytes for value in plan.checkpoint.values())
    kept = [*plan.arrays.values(), *plan.bodies.values()]
    count += sum(np.asarray(array).nbytes for arrays in kept for array in arrays.values())
    count += ROD_BYTES * len(plan.bodies) + 2 * 8 * 4 * len(plan.triangles)  # cells of the view
    count += POINT_BYTES * (plan.points + plan.tracers) + ROD_BYTES * len(plan.rods)
    return count + FILE_BYTES


def size(count: float) -> str:
    """Return a number of bytes as it is read."""
    for unit in ("bytes", "kB", "MB", "GB", "TB"):
        if count < 999.5:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:.3g} PB"


def _reserve(file, count):
    """Take the disk space before HDF5 writes: a full disk can make it crash, this only fails."""
    if not hasattr(os, "posix_fallocate"):
        return
    try:
        os.posix_fallocate(rows.descriptor(file), 0, count)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.EOPNOTSUPP, errno.ENOSYS):
            raise


def _fill(file, plan):
    _add_root(file)
    _add_case(file.create_group("case"), plan)
    _add_rods(file.create_group("rods"), plan)
    if plan.bodies:
        _add_bodies(file.create_group("bodies"), plan.bodies)
    _add_series(file, plan)
    describe(file)
    _add_runtime(file.create_group("runtime"), plan.device)
    allocate(file.create_group("checkpoint"), plan.checkpoint)
    build_view(file, plan)
    file.flush()


def _add_root(file):
    from rodsim import __version__

    file.attrs["filetype"] = layout.FILETYPE
    file.attrs["format"] = np.int64(layout.FORMAT)
    file.attrs["creator"] = "rodsim"
    file.attrs["version"] = __version__
    file.attrs["created"] = datetime.now(UTC).isoformat(timespec="seconds")
    file.attrs.create("status", np.bytes_("running"), dtype=f"S{layout.TEXT_BYTES}")
    file["committed"] = np.int64(0)


def _add_case(group, plan):
    text, overrides = h5py.string_dtype(), plan.case.overrides
    group.create_dataset("source", data=plan.case.source, dtype=text)
    group.create_dataset("resolved", data=plan.case.resolved, dtype=text)
    if plan.case.inputs:
        group.create_dataset("inputs", data=plan.case.inputs, dtype=text)
    group.create_dataset("overrides", (len(overrides),), data=overrides, dtype=text)
    group["times"] = plan.times
    group["resumes"] = np.zeros(layout.MOST_RESUMES, dtype=f"S{layout.RESUME_BYTES}")
    for kind in ("length", "mass", "time"):
        group.attrs[f"{kind}_unit"] = plan.units[kind]


def _add_rods(group, plan):
    for index, rod in enumerate(plan.rods):
        a1, a2, a3, b1, b2, b3 = rod.moduli
        place = group.create_group(rod.name)
        attrs = place.attrs
        attrs["index"] = np.int64(index)
        attrs["first"], attrs["count"] = np.int64(rod.first), np.int64(rod.count)
        attrs["closed"], attrs["spacing"] = bool(rod.closed), float(rod.spacing)
        attrs["moduli"] = np.array(rod.moduli, dtype=float)
        attrs["bending"], attrs["twisting"] = [a1, a2], a3
        attrs["shear"], attrs["stretch"] = [b1, b2], b3
        for name, array in plan.arrays.get(rod.name, {}).items():
            place[name] = array


def _add_bodies(group, bodies):
    for index, (name, kept) in enumerate(bodies.items()):
        place = group.create_group(name)
        place.attrs["index"] = np.int64(index)
        for key, value in kept.items():
            if np.ndim(value):
                place[key] = value
            else:
                place.attrs[key] = float(value)


def _add_series(file, plan):
    frames = len(plan.times)
    file.create_group("particles", track_order=True)  # H5MD readers may take its first group
    clock = file.create_group(CLOCK)
    time = rows.make_room(clock, "time", (frames,), np.float64, np.nan)
    step = rows.make_room(clock, "step", (frames,), np.int64, -1)
    time.attrs["units"] = unit_text(layout.TIME, plan.units)
    for series in plan.stored():
        group = file.require_group(series.where)
        value = rows.make_room(group, "value", (frames, *series.shape), np.float64, np.nan)
        value.attrs["units"] = unit_text(series.dimension, plan.units)
        if series.name in plan.labels:
            value.attrs["rows"] = ", ".join(plan.labels[series.name])
        if series.where != CLOCK:
            group["time"], group["step"] = time, step


def _add_runtime(group, device):
    text = f"S{layout.TEXT_BYTES}"
    for name, kind in layout.RUNTIME.items():
        group.attrs.create(name, layout.UNKNOWN[kind], dtype=text if kind is str else None)
    for name, value in (machine() | device).items():
        group.attrs.create(name, np.bytes_(value), dtype=text)
