"""Rods that start from a file: an earlier output, or a table of points and triads."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from rodsim.errors import FileError
from rodsim.files import has_hdf5_signature
from rodsim.scene.data.points import read_points
from rodsim.scene.data.triads import orthonormal
from rodsim.scene.geometry import Geometry, check_geometry
from rodsim.units import length_factor

AGREES = 1e-3  # relative, of a spacing typed beside that of an output


@dataclass
class Built:
    """A rod as built: position (3, M), director (3, 3, M), spacing, closed; what is wrong with it.

    ``errors``, ``warnings``: (key of the shape, reason).
    """

    position: np.ndarray
    director: np.ndarray
    spacing: float
    closed: bool
    errors: list = field(default_factory=list)
    warnings: list = field(default_factory=list)


def find_file(path, folder) -> Path:
    """Return where a file named in a case lies, relative to the case's folder."""
    found = Path(folder) / path
    if not found.is_file():
        raise FileError(f"{found}: no such file")
    return found


def read_shape(shape, folder, unit) -> Built:
    """Return the rod of a ``kind: file`` shape, in the case's unit of length; raises FileError.

    ``folder`` is where the case file lies: a relative path is relative to it.
    """
    path = find_file(shape.path, folder)
    if has_hdf5_signature(path):
        return _from_output(shape, path, unit)
    return _from_table(shape, path, unit)


def in_unit(found, unit, as_is=False):
    """Return the factor from a file's unit of length to the case's, errors and warnings."""
    if found is None or found == unit:
        return 1.0, [], []
    factor = length_factor(found, unit)
    if factor is None and as_is:
        return 1.0, [], []
    if factor is None:
        known = f"cannot be converted from {found} to {unit}"
        return (
            1.0,
            [("path", f"its lengths {known}: name units.length as there, or as_is: true")],
            [],
        )
    if factor == 1.0:
        return 1.0, [], []
    return factor, [], [("path", f"its lengths are in {found}: multiplied by {factor:g} to {unit}")]


def _from_output(shape, path, unit):
    from rodsim.output import open_trajectory

    with open_trajectory(path) as run:
        names = [rod.name for rod in run.rods]
        name = shape.rod if shape.rod is not None else names[0]
        if name not in names or (shape.rod is None and len(names) > 1):
            raise FileError(f"{path}: 'rod' must be one of {', '.join(names)}")
        rod = run.rods[names.index(name)]
        frame = -1 if shape.frame is None else shape.frame
        if not -run.frames <= frame < run.frames:
            raise FileError(f"{path}: frame {frame} of {run.frames} does not exist")
        at = slice(frame % run.frames, frame % run.frames + 1)
        nodes = slice(rod.first, rod.first + rod.count)
        position = run.read("position", at)[0, nodes]
        director = run.read("director", at)[0, nodes]
        factor, errors, warnings = in_unit(run.units["length"], unit, shape.as_is)
        if run.status == "diverged" and not shape.as_is:
            reason = "its run diverged: start from another run, or as_is: true"
            errors.append(("path", reason))
    position = position.T.copy() if factor == 1.0 else factor * position.T
    spacing = rod.spacing if factor == 1.0 else factor * rod.spacing
    built = Built(position, director.transpose(1, 2, 0).copy(), spacing, rod.closed)
    errors += _beside(shape, spacing, rod.closed)
    if shape.unit not in (None, run.units["length"]):
        errors.append(("unit", f"the output is in {run.units['length']}: leave it out"))
    built.errors, built.warnings = errors, warnings
    return built


def _beside(shape, spacing, closed):
    """Return what is given beside a file that says it itself, and differs."""
    if shape.closed is not None and closed is not None and shape.closed != closed:
        yield "closed", f"the rod in the file is {'closed' if closed else 'open'}: leave it out"
    if shape.spacing is not None and abs(shape.spacing / spacing - 1.0) > AGREES:
        yield "spacing", f"the rod in the file has {spacing:.6g}: leave it out"


def _from_table(shape, path, unit):
    points = read_points(path, True, shape.columns, shape.frame, shape.rod)
    director, note = orthonormal(points)
    factor, errors, warnings = in_unit(shape.unit or points.unit, unit, shape.as_is)
    warnings += [("path", note)] * (note is not None)
    position = factor * points.position.T if factor != 1.0 else points.position.T.copy()
    spacing, closed = shape.spacing, bool(shape.closed)
    if points.spacing is not None:
        spacing = points.spacing * factor if factor != 1.0 else points.spacing
        errors += _beside(shape, spacing, points.closed)
        closed = closed if points.closed is None else points.closed
    director = director.transpose(1, 2, 0).copy()
    built = Built(position, director, spacing, closed, errors, warnings)
    built.errors += _count(built)
    if not built.errors and not shape.as_is:
        _hold(built, points)
    return built


def _count(built):
    """Return what a table lacks to be a rod."""
    if built.spacing is None:
        yield "spacing", "missing: a table needs the spacing of its points at rest"
    count, least = built.position.shape[1], 3 if built.closed else 2
    if count < least:
        kind = "a closed rod" if built.closed else "a rod"
        yield "path", f"has {count} point{'s' * (count > 1)}: {kind} has at least {least}"


def _hold(built, points):
    """Hold a table against its own geometry."""
    if points.breaks:
        where = points.name(points.breaks[0])
        blocks = f"has {len(points.breaks) + 1} blocks, the second from {where} on"
        reason = (
            f"{blocks}: choose one by its number, rod: 1; or take blank lines out of a single curve"
        )
        built.errors.append(("path", f"{reason}, or as_is: true"))
        return
    geometry = Geometry(built.position, built.director, built.spacing, built.closed)
    errors, warnings = check_geometry(geometry, points.name)
    built.errors += [("path", f"{reason} (as_is: true takes it so)") for reason in errors]
    built.warnings += [("path", reason) for reason in warnings]
