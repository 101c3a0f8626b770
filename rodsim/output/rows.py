"""Writes to an open output file, at every frame: what h5py does around each takes the time of many.

Datasets of fixed size lie in one piece whose place in the file never changes, and HDF5 is told to
keep none of it in memory: numbers go there without it, a tenth of the time. What grows or belongs
to a group is written by HDF5's own calls.
"""

import os

import h5py
import numpy as np


def open_to_write(path, new: bool) -> h5py.File:
    """Open a file, or create it, whose datasets HDF5 does not keep pieces of in memory.

    Who reads it in this process shares HDF5's memory with the writer: a dataset that stays open
    there would go on showing a piece as it was before numbers were written past HDF5.
    """
    access, name = h5py.h5p.create(h5py.h5p.FILE_ACCESS), os.fsencode(path)
    access.set_libver_bounds(h5py.h5f.LIBVER_EARLIEST, h5py.h5f.LIBVER_LATEST)
    access.set_file_locking(False, ignore_when_disabled=False)
    access.set_sieve_buf_size(0)
    if new:
        return h5py.File(h5py.h5f.create(name, h5py.h5f.ACC_EXCL, fapl=access))
    return h5py.File(h5py.h5f.open(name, h5py.h5f.ACC_RDWR, fapl=access))


def descriptor(file: h5py.File) -> int:
    """Return the system's number of the open file."""
    return file.id.get_vfd_handle()


def write_at(handle: int, data: memoryview, offset: int) -> None:
    """Write all bytes at an offset of an open file; OSError where that fails."""
    while data:
        count = os.pwrite(handle, data, offset)
        data, offset = data[count:], offset + count


def make_room(group: h5py.Group, name: str, shape, dtype, fill=0) -> h5py.Dataset:
    """Create a dataset of fixed size in one piece, allocated and filled at once."""
    properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    properties.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    properties.set_fill_time(h5py.h5d.FILL_TIME_ALLOC)
    properties.set_fill_value(np.array(fill, dtype))
    properties.set_obj_track_times(False)
    kind, room = h5py.h5t.py_create(np.dtype(dtype), logical=True), h5py.h5s.create_simple(shape)
    return h5py.Dataset(h5py.h5d.create(group.id, name.encode(), kind, room, properties))


def put_whole(group: h5py.Group, name: str, values, dtype=np.int64) -> h5py.Dataset:
    """Create a dataset that never changes."""
    values = np.array(values, dtype)
    dataset = make_room(group, name, values.shape, dtype)
    if values.size:
        dataset.id.write(h5py.h5s.ALL, h5py.h5s.ALL, values)
    return dataset


class Rows:
    """The rows of a dataset of fixed size, or a single number. After a flush of the file."""

    def __init__(self, file: h5py.File, name: str):
        dataset = h5py.h5d.open(file.id, name.encode())
        self.shape, self.dtype = dataset.shape, dataset.dtype
        self._handle, self._offset = descriptor(file), dataset.get_offset()

    def put(self, index: int, row) -> None:
        """Write one row."""
        self._put(row, self.shape[1:], index)

    def put_all(self, values) -> None:
        """Write the whole dataset."""
        self._put(values, self.shape, 0)

    def _put(self, values, shape, index):
        values = np.asarray(values, dtype=self.dtype, order="C")
        if values.shape != shape:
            raise ValueError(f"{values.shape} where {shape} is stored")
        if values.size:
            write_at(self._handle, values.data.cast("B"), self._offset + index * values.nbytes)


class Growing:
    """A list of numbers that grows within its one chunk."""

    def __init__(self, dataset: h5py.Dataset):
        self.length = len(dataset)
        self._id, self._type = dataset.id, h5py.h5t.py_create(dataset.dtype)
        self._dtype, self._one = dataset.dtype, h5py.h5s.create_simple((1,))

    def put(self, index: int, value) -> None:
        """Write one number: the next, or an earlier one again."""
        if index >= self.length:
            self.length = index + 1
            self._id.set_extent((self.length,))
        space = self._id.get_space()
        space.select_hyperslab((index,), (1,))
        self._id.write(self._one, space, np.array([value], dtype=self._dtype), self._type)


class Counter:
    """An attribute that is one whole number."""

    def __init__(self, node: h5py.Group, name: str):
        self._id = h5py.h5a.open(node.id, name.encode())
        self._type = h5py.h5t.py_create(np.dtype(np.int64))

    def put(self, value: int) -> None:
        """Write it, in place."""
        self._id.write(np.array(value, dtype=np.int64), self._type)
