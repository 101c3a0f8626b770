"""Rods that start from a file: an earlier output, or a text table x y z D1 D2 D3."""

import warnings
from pathlib import Path

import numpy as np

from rodsim.errors import FileError
from rodsim.files import has_hdf5_signature

TRIAD_TOLERANCE = 1e-4  # tables are often written with few digits


def read_shape(shape, folder):
    """Return position (3, M), director (3, 3, M), spacing and closed of a ``kind: file`` shape.

    ``folder`` is where the case file lies: a relative path is relative to it. Raises FileError.
    """
    path = Path(folder) / shape.path
    if not path.is_file():
        raise FileError(f"{path}: no such file (shape of kind 'file')")
    if has_hdf5_signature(path):
        return _from_output(shape, path)
    return *_from_table(path), shape.spacing, shape.closed


def _from_output(shape, path):
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
    return position.T.copy(), director.transpose(1, 2, 0).copy(), rod.spacing, rod.closed


def _from_table(path):
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of an empty file: said below
            table = np.loadtxt(path, ndmin=2)
    except (ValueError, OSError, UnicodeDecodeError) as error:
        raise FileError(f"{path}: cannot be read as a table of numbers: {error}") from error
    if table.shape[1:] != (12,) or len(table) < 2 or not np.isfinite(table).all():
        raise FileError(
            f"{path}: needs at least 2 rows of 12 finite numbers, x y z D1 D2 D3; "
            f"has {' x '.join(map(str, table.shape))}"
        )
    triads = table[:, 3:].reshape(-1, 3, 3)
    errors = np.abs(triads @ triads.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2))
    bad = (errors > TRIAD_TOLERANCE) | (np.linalg.det(triads) < 0.0)
    if bad.any():
        raise FileError(
            f"{path}: row {int(np.argmax(bad)) + 1}: D1 D2 D3 are not a right-handed "
            "orthonormal triad"
        )
    left, _, right = np.linalg.svd(triads)  # nearest rotation: removes the table's rounding
    return table[:, :3].T.copy(), (left @ right).transpose(1, 2, 0).copy()
