"""Datasets written whole or row by row through HDF5's own calls: h5py's indexing costs more.

A frame is some twenty small writes; through ``dataset[index] = row`` they take longer than the
evaluation that the frame is made of.
"""

import h5py
import numpy as np


class Rows:
    """Writes rows of a dataset, each where the first index says."""

    def __init__(self, dataset: h5py.Dataset):
        self._id, self._dtype, shape = dataset.id, dataset.dtype, dataset.shape[1:]
        self._rest, self._count = (0,) * len(shape), (1, *shape)
        self._target = dataset.id.get_space()
        self._source = h5py.h5s.create_simple(self._count)

    def write(self, index: int, row) -> None:
        """Write one row; its shape must be right."""
        self._target.select_hyperslab((index, *self._rest), self._count)
        values = np.ascontiguousarray(row, self._dtype)
        self._id.write(self._source, self._target, values)


def put(dataset: h5py.Dataset, array: np.ndarray) -> None:
    """Write a whole dataset from a contiguous array of its own shape and type."""
    dataset.id.write(h5py.h5s.ALL, h5py.h5s.ALL, array)
