"""Writes to datasets and attributes that stay open, through HDF5's own calls.

What h5py does around each of them takes five times as long as the write, and there are some twenty
at every frame.
"""

import h5py
import numpy as np


class Rows:
    """The rows of a dataset of fixed size, or a single number."""

    def __init__(self, dataset: h5py.Dataset):
        self.shape, self.dtype = dataset.shape, dataset.dtype
        self._id, self._space = dataset.id, dataset.id.get_space()
        self._one = (1, *dataset.shape[1:])
        self._row = h5py.h5s.create_simple(self._one)

    def put(self, index: int, row) -> None:
        """Write one row."""
        self._space.select_hyperslab((index,) + (0,) * (len(self._one) - 1), self._one)
        values = np.ascontiguousarray(row, dtype=self.dtype).reshape(self._one)
        self._id.write(self._row, self._space, values)

    def put_all(self, values) -> None:
        """Write the whole dataset."""
        values = np.asarray(values, dtype=self.dtype, order="C")
        self._id.write(h5py.h5s.ALL, h5py.h5s.ALL, values)


def put_number(dataset: h5py.Dataset, index: int, value) -> None:
    """Write one number of a dataset that grows."""
    space = dataset.id.get_space()
    space.select_elements([(index,)])
    dataset.id.write(h5py.h5s.create_simple((1,)), space, np.array([value], dtype=dataset.dtype))


class Counter:
    """An attribute that is one whole number."""

    def __init__(self, node: h5py.Group, name: str):
        self._id = h5py.h5a.open(node.id, name.encode())

    def put(self, value: int) -> None:
        """Write it, in place."""
        self._id.write(np.array(value, dtype=np.int64))
