"""The integrator's state, stored twice in turn: a kill while one is written leaves the other.

``/checkpoint/a`` and ``/checkpoint/b`` hold one dataset per entry and ``seal``: serial number and
CRC32 of everything, written last. Only a slot whose seal matches its contents counts.
"""

from __future__ import annotations

from zlib import crc32

import h5py
import numpy as np

SLOTS = ("a", "b")
SEAL = "seal"


class CheckpointWriter:
    """Writes states of one shape in turn to the two slots of an empty ``/checkpoint``."""

    def __init__(self, group: h5py.Group):
        self._group, self._serial = group, 0

    def write(self, state: dict) -> None:
        """Store arrays and numbers by name; raises ValueError where names or shapes change."""
        arrays = {name: np.asarray(value) for name, value in sorted(state.items())}
        if len(self._group) == 0:
            self._create(arrays)
        slot = self._group[SLOTS[self._serial % 2]]
        if set(slot) != {*arrays, SEAL}:
            raise ValueError(f"checkpoint has {sorted(arrays)}, its file {sorted(slot)}")
        for name, array in arrays.items():
            if (slot[name].shape, slot[name].dtype) != (array.shape, array.dtype):
                raise ValueError(f"checkpoint: {name} changed its shape or type")
        for name, array in arrays.items():
            slot[name][...] = array
        self._group.file.flush()
        self._serial += 1
        slot[SEAL][:] = self._serial, checksum(self._serial, arrays)
        self._group.file.flush()

    def _create(self, arrays):
        for name, array in arrays.items():
            if array.dtype.kind not in "fiub" or name == SEAL:
                raise ValueError(f"checkpoint: {name} cannot be stored")
        for slot in map(self._group.create_group, SLOTS):
            for name, array in arrays.items():
                slot[name] = np.zeros_like(array)
            slot[SEAL] = np.zeros(2, dtype=np.int64)
        self._group.file.flush()


def checksum(serial: int, arrays: dict[str, np.ndarray]) -> int:
    """Return the CRC32 of a serial number and of names, types, shapes and bytes, by name."""
    crc = crc32(str(serial).encode())
    for name, array in sorted(arrays.items()):
        crc = crc32(f"{name} {array.dtype.str} {array.shape}".encode(), crc)
        crc = crc32(np.ascontiguousarray(array).tobytes(), crc)
    return crc


def newest(slots: list[tuple[int, int, dict[str, np.ndarray]]]) -> dict | None:
    """Return the newest of (serial, crc, arrays) that is whole; single numbers as such."""
    whole = [slot for slot in slots if slot[0] > 0 and checksum(slot[0], slot[2]) == slot[1]]
    if not whole:
        return None
    arrays = max(whole, key=lambda slot: slot[0])[2]
    return {name: array if array.shape else array.item() for name, array in arrays.items()}
