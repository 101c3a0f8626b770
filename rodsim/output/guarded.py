"""Access to an HDF5 file that may come from anywhere: whatever is wrong becomes a FileError."""

from __future__ import annotations

import shlex
from pathlib import Path

import h5py
import numpy as np

from rodsim.errors import FileError, UsageError
from rodsim.output.packed import PACKING, what_is_wrong

CASES = (".yaml", ".yml")  # suffixes
ATTRIBUTE_KINDS = {str: "", bool: "b", int: "iu", float: "f"}


class GuardedFile:
    """Groups, datasets and attributes of one file, checked for what they are before they are read.

    Nothing outside the file is opened: no soft or external link, no virtual dataset, no external
    storage.
    """

    def __init__(self, path):
        self.path, self._groups = Path(path), {}
        if not self.path.exists():
            raise FileError(f"{path}: no such file")
        try:
            if not (self.path.is_file() and h5py.is_hdf5(self.path)):
                raise FileError(f"{path}: not an HDF5 file{_case_hint(self.path)}")
            self._file = h5py.File(self.path, "r", locking=False)
        except OSError as error:
            raise FileError(f"{path}: cannot be opened, damaged or cut short ({error})") from error

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    @property
    def is_open(self) -> bool:
        """Whether it can still be read from."""
        return bool(self._file)

    def _check_open(self):
        if not self._file:
            raise UsageError(
                f"{self.path}: is closed, and this was not read before: read inside the with "
                "block, or open it again"
            )

    def damaged(self, what: str) -> FileError:
        """Return the error that says what is wrong with the file."""
        return FileError(f"{self.path}: damaged: {what}")

    def names(self, group: str) -> list[str]:
        """Return the names in a group, none if there is no such group."""
        self._check_open()
        try:
            node = self._node(group, h5py.Group)
        except FileError:
            return []
        try:
            return list(node)
        except (OSError, RuntimeError, ValueError) as error:
            raise self.damaged(f"{group} cannot be listed ({error})") from error

    def attribute(self, name: str, key: str, kind: type, shape=()):
        """Return an attribute: ``kind`` is str, bool, int or float; an array if it has a shape."""
        value = self._attribute(self._node(name), key)
        if kind is str and isinstance(value, str):
            return value
        array = np.asarray(value)
        if array.shape != shape or array.dtype.kind not in ATTRIBUTE_KINDS[kind]:
            raise self.damaged(f"{name} has no proper {key}")
        return array if shape else kind(array)

    def attributes(self, name: str) -> dict:
        """Return those attributes of a group that are single numbers or texts."""
        node = self._node(name)
        try:
            keys = list(node.attrs)
        except (OSError, RuntimeError, ValueError) as error:
            raise self.damaged(f"{name} has no proper attributes ({error})") from error
        found = {key: self._attribute(node, key) for key in keys}
        return {
            key: value if isinstance(value, str) else value.item()
            for key, value in found.items()
            if isinstance(value, np.number | str)
        }

    def _attribute(self, node, key):
        try:
            value = node.attrs[key]
            if isinstance(value, str):
                value = value.encode()  # refuses the stand-ins for bytes that are not text
            return value.decode() if isinstance(value, bytes) else value
        except (KeyError, OSError, RuntimeError, TypeError, ValueError) as error:
            raise self.damaged(f"{node.name} has no proper {key}") from error

    def array(self, name: str, kinds: str, shape, rows=(), at_least=0) -> np.ndarray:
        """Return a dataset, or some ``rows`` of it; it must have ``at_least`` so many.

        ``kinds`` are the kinds of dtype allowed, ``shape`` the expected one: None is any length,
        and the whole of it None is any shape.
        """
        data = self._dataset(name)
        if data.dtype.kind not in kinds or not _fits(data.shape, shape):
            raise self.damaged(f"{name} has shape {data.shape} of {data.dtype}")
        if at_least and len(data) < at_least:
            raise self.damaged(f"{name} has {len(data)} frames of {at_least}")
        return self._contents(name, data, rows)

    def contiguous(self, name: str, kinds: str, shape) -> None:
        """Check a dataset that is to be written: in one piece, as the run has made it."""
        self.array(name, kinds, shape, np.s_[:0] if shape else ())
        data = self._dataset(name)
        size = data.size * data.dtype.itemsize
        place = data.id.get_offset()
        if size and (place is None or data.id.get_storage_size() != size):
            raise self._laid_out_anew(name)
        if size and place + size > self.path.stat().st_size:  # not every HDF5 looks
            raise self.damaged(f"{name} lies beyond its end")

    def growing(self, name: str, kinds: str) -> None:
        """Check a list that is to be lengthened."""
        self.array(name, kinds, (None,), np.s_[:0])
        if self._dataset(name).chunks is None:
            raise self._laid_out_anew(name)

    def _laid_out_anew(self, name):
        return FileError(
            f"{self.path}: {name} was laid out anew by another program (h5repack?), so it can be "
            "read, and gone on with in a new copy: rodsim resume with a later --set time.end=..."
        )

    def text(self, name: str) -> str:
        """Return a text dataset."""
        return self._decoded(name, ())

    def texts(self, name: str) -> list[str]:
        """Return a dataset that is a list of texts."""
        return list(self._decoded(name, (None,)))

    def _decoded(self, name, shape):
        data = self._dataset(name)
        if h5py.check_string_dtype(data.dtype) is None or not _fits(data.shape, shape):
            raise self.damaged(f"{name} is not text")
        return self._contents(name, data.asstr(errors="replace"), ())

    def _contents(self, name, data, rows):
        try:
            return data[rows]
        except (OSError, RuntimeError, TypeError, ValueError, MemoryError) as error:
            raise self.damaged(f"{name} cannot be read ({error})") from error

    def _dataset(self, name):
        data = self._node(name, h5py.Dataset)
        try:
            self._check_storage(name, data)
        except (OSError, OverflowError, RuntimeError, TypeError, ValueError) as error:
            raise self.damaged(f"{name} has a type or layout that is none ({error})") from error
        return data

    def _check_storage(self, name, data):
        if data.external or data.is_virtual:
            raise self.damaged(f"{name} lies outside this file")
        stored = data.shape is not None and data.dtype.itemsize  # an impossible type fails here
        if not stored or data.nbytes > PACKING * data.id.get_storage_size():
            raise self.damaged(f"{name} is empty")
        if wrong := what_is_wrong(data):
            raise self.damaged(f"{name} {wrong}")

    def _node(self, name, kind=h5py.HLObject):
        """Walk to an object link by link; groups are kept open, since most things share theirs."""
        self._check_open()
        node, path = self._file, ""
        try:
            for part in filter(None, name.split("/")):
                path += f"/{part}"
                node = self._groups.get(path) or self._below(node, part, name)
                if isinstance(node, h5py.Group):
                    self._groups[path] = node
        except (KeyError, AttributeError, TypeError, OSError, RuntimeError, ValueError) as error:
            raise self.damaged(f"{name} is missing") from error
        if not isinstance(node, kind):
            raise self.damaged(f"{name} is not a {kind.__name__.lower()}")
        return node

    def _below(self, node, part, name):
        """Return what a group has of a name, where that is no link to elsewhere."""
        if node.id.links.get_info(part.encode()).type != h5py.h5l.TYPE_HARD:
            raise self.damaged(f"{name} is a link to elsewhere")
        return node[part]


def _case_hint(path):
    """Return what to do where a case was given instead of its output."""
    if path.suffix not in CASES or not path.is_file():
        return ""
    return f", but a case? First rodsim run {shlex.quote(str(path))}, then give its output"


def _fits(found, expected):
    if expected is None:
        return True
    return len(found) == len(expected) and all(
        wanted in (None, length) for length, wanted in zip(found, expected, strict=True)
    )
