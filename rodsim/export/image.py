"""A grid of values as VTKHDF ImageData, the format of ParaView's own images."""

from __future__ import annotations

import h5py
import numpy as np

from rodsim.files import replacing

VERSION = (1, 0)


def write_image(path, origin, step, shape, data: dict) -> None:
    """Write point data on a regular grid; raises FileError.

    ``shape`` = (nx, ny, nz); ``data``: name -> array (n,) or (n, 3), n = nx ny nz, x slowest.
    """
    with replacing(path) as temporary, h5py.File(temporary, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array(VERSION, dtype=np.int64)
        root.attrs.create("Type", np.bytes_("ImageData"))
        extent = [bound for count in shape for bound in (0, count - 1)]
        root.attrs["WholeExtent"] = np.array(extent, dtype=np.int64)
        root.attrs["Origin"] = np.array(origin, dtype=float)
        root.attrs["Spacing"] = np.array(step, dtype=float)
        root.attrs["Direction"] = np.eye(3).ravel()
        points = root.create_group("PointData")
        for name, values in data.items():
            cube = values.reshape(*shape, *values.shape[1:])
            points[name] = np.ascontiguousarray(cube.swapaxes(0, 2))  # VTK: x fastest
