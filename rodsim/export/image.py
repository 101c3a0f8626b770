"""A grid of values as VTK ImageData, .vti: XML with the numbers appended as they are."""

from __future__ import annotations

import sys

import numpy as np

from rodsim.files import replacing


def write_image(path, origin, step, shape, data: dict) -> None:
    """Write point data on a regular grid of any dimension; raises FileError.

    ``shape`` = (nx, ny, nz); ``data``: name -> array (n,) or (n, 3), n = nx ny nz, x slowest.
    """
    blocks, offset, entries = [], 0, []
    for name, values in data.items():
        cube = values.reshape(*shape, *values.shape[1:]).swapaxes(0, 2)  # VTK: x fastest
        block = np.ascontiguousarray(cube, dtype=np.float64).tobytes()
        blocks += [np.uint64(len(block)).tobytes(), block]
        entries.append(
            f'<DataArray type="Float64" Name="{name}" NumberOfComponents="{cube[0, 0, 0].size}" '
            f'format="appended" offset="{offset}"/>'
        )
        offset += 8 + len(block)
    with replacing(path) as temporary, open(temporary, "wb") as stream:
        stream.write(_head(origin, step, shape, entries).encode())
        stream.writelines(blocks)
        stream.write(b"\n</AppendedData></VTKFile>\n")


def _head(origin, step, shape, entries):
    extent = " ".join(f"0 {count - 1}" for count in shape)
    start, spacing = (" ".join(repr(float(x)) for x in v) for v in (origin, step))
    order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
    return f"""<?xml version="1.0"?>
<VTKFile type="ImageData" version="1.0" byte_order="{order}" header_type="UInt64">
<ImageData WholeExtent="{extent}" Origin="{start}" Spacing="{spacing}">
<Piece Extent="{extent}"><PointData>
{chr(10).join(entries)}
</PointData></Piece></ImageData>
<AppendedData encoding="raw">_"""
