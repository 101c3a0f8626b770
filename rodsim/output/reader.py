"""Reads an output file, also of a run that goes on or was killed. Trusts nothing in it."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np

from rodsim.errors import FileError
from rodsim.output import layout
from rodsim.output.layout import CLOCK, TRACERS, TRAJECTORY, RodRecord


def open_trajectory(path) -> Trajectory:
    """Open an output file of rodsim for reading; raises FileError in one line if it is not one.

    >>> with open_trajectory("out.h5") as run:
    ...     run.time, run.position, run.observable("bending_energy")
    """
    return Trajectory(Path(path))


class Trajectory:
    """The committed frames of an output file: T frames, N points, R rods. A context manager.

    Attributes
    ----------
    frames : T. time, step : (T,). position : (T, N, 3). director : (T, N, 3, 3), with
    [t, point, i, :] = D^(i+1). tracers : (T, P, 3), P may be 0. rods : list of RodRecord.
    status : running, finished, stopped or diverged. units : dict of unit names.
    case_source, case_resolved : text; overrides : list of text. runtime : dict.
    """

    def __init__(self, path: Path):
        self.path = path
        if not path.is_file():
            raise FileError(f"{path}: no such file")
        try:
            self._file = h5py.File(path, "r", locking=False)
        except OSError as error:
            raise FileError(f"{path}: not an HDF5 file, or damaged") from error
        try:
            self._check()
        except FileError:
            self._file.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def read(self, name: str, frames=slice(None)) -> np.ndarray:
        """Return a stored field of the chosen frames, ``read("director", slice(-1, None))``."""
        if name == "tracers":
            return self._value(TRACERS, frames)
        return self._value(f"{TRAJECTORY}/{name}", frames)

    def observable(self, name: str) -> np.ndarray:
        """Return an observable, (T, R) or (T, 3)."""
        return self._value(f"observables/{name}")

    @property
    def fields(self) -> list[str]:
        """Names of the stored fields."""
        return list(self._group(TRAJECTORY))

    @property
    def observables(self) -> list[str]:
        """Names of the observables."""
        return list(self._group("observables"))

    @property
    def position(self):
        """All positions, (T, N, 3)."""
        return self.read("position")

    @property
    def director(self):
        """All triads, (T, N, 3, 3)."""
        return self.read("director")

    @property
    def tracers(self):
        """All tracer positions, (T, P, 3)."""
        return self.read("tracers") if TRACERS in self._file else np.zeros((self.frames, 0, 3))

    def unit(self, name: str) -> str:
        """Return the unit of a field or observable."""
        where = f"{TRAJECTORY}/{name}" if name in self.fields else f"observables/{name}"
        return str(self._dataset(f"{where}/value").attrs.get("units", "1"))

    def _check(self):
        attrs = self._file.attrs
        if _text(attrs.get("filetype")) != layout.FILETYPE:
            raise FileError(f"{self.path}: not an output file of rodsim")
        found = attrs.get("format")
        if not isinstance(found, np.integer) or found != layout.FORMAT:
            raise FileError(f"{self.path}: format {found}; this rodsim reads {layout.FORMAT}")
        self.format = int(found)
        self.status = _text(attrs.get("status"))
        self.version = _text(attrs.get("version"))
        self.created = _text(attrs.get("created"))
        self.frames = self._committed()
        self.time = self._rows(f"{CLOCK}/time")
        self.step = self._rows(f"{CLOCK}/step")
        self.rods = self._read_rods()
        self.case_source = self._read_text("case/source")
        self.case_resolved = self._read_text("case/resolved")
        self.overrides = [_text(entry) for entry in self._dataset("case/overrides")[()]]
        self.runtime = {key: value.item() for key, value in self._group("runtime").attrs.items()}
        try:
            self.units = json.loads(_text(self._group("case").attrs["units"]))
        except (KeyError, ValueError) as error:
            raise FileError(f"{self.path}: damaged: case units cannot be read") from error

    def _committed(self):
        dataset = self._dataset("committed")
        if dataset.shape != () or dataset.dtype.kind != "i" or dataset[()] < 0:
            raise FileError(f"{self.path}: damaged: the count of frames is not a number")
        return int(dataset[()])

    def _read_rods(self):
        records = []
        try:
            for name, node in self._group("rods").items():
                a = node.attrs
                moduli = (*a["bending"], a["twisting"], *a["shear"], a["stretch"])
                record = RodRecord(
                    name,
                    int(a["first"]),
                    int(a["count"]),
                    bool(a["closed"]),
                    float(a["spacing"]),
                    tuple(map(float, moduli)),
                )
                records.append((int(a["index"]), record))
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise FileError(f"{self.path}: damaged: rods cannot be read ({error})") from error
        return [record for _, record in sorted(records, key=lambda pair: pair[0])]

    def _read_text(self, name):
        return _text(self._dataset(name)[()])

    def _value(self, where, frames=slice(None)):
        return self._rows(f"{where}/value", frames)

    def _rows(self, name, frames=slice(None)):
        dataset = self._dataset(name)
        if dataset.ndim == 0 or len(dataset) < self.frames:
            raise FileError(f"{self.path}: damaged: {name} has fewer frames than committed")
        start, stop, stride = frames.indices(self.frames)
        return dataset[start:stop:stride]

    def _group(self, name):
        node = self._node(name)
        if not isinstance(node, h5py.Group):
            raise FileError(f"{self.path}: damaged: no group {name}")
        return node

    def _dataset(self, name):
        """Return a dataset of this very file: no external link, storage or virtual source."""
        node = self._node(name)
        if not isinstance(node, h5py.Dataset) or node.external or node.is_virtual:
            raise FileError(f"{self.path}: damaged: {name} is not a dataset of this file")
        return node

    def _node(self, name):
        node = self._file
        for part in name.split("/"):
            if not isinstance(node, h5py.Group) or part not in node:
                raise FileError(f"{self.path}: has no {name}")
            if isinstance(node.get(part, getlink=True), h5py.ExternalLink | h5py.SoftLink):
                raise FileError(f"{self.path}: damaged: {name} is a link to elsewhere")
            node = node[part]
        return node


def _text(value):
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace").rstrip("\0")
    return str(value)
