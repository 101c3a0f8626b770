"""The state of a run, stored twice in turn: a kill while one is written leaves the other.

``/checkpoint/a`` and ``/checkpoint/b`` hold one dataset per entry and ``seal``: serial number and
CRC32 of everything, written last. Only a slot whose seal matches its contents counts.
"""

from __future__ import annotations

from zlib import crc32

import h5py
import numpy as np

from rodsim.errors import FileError
from rodsim.output.guarded import GuardedFile
from rodsim.output.rows import Rows, make_room

SLOTS = ("a", "b")
SEAL = "seal"


def allocate(group: h5py.Group, state: dict) -> None:
    """Make both slots for states with the names, shapes and types of this one."""
    arrays = _arrays(state)
    for name, array in arrays.items():
        if array.dtype.kind not in "fiub" or name == SEAL:
            raise ValueError(f"checkpoint: {name} cannot be stored")
    for slot in map(group.create_group, SLOTS):
        for name, array in arrays.items():
            make_room(slot, name, array.shape, array.dtype)
        make_room(slot, SEAL, (2,), np.int64)


class CheckpointWriter:
    """Writes states of one shape in turn to the two slots of ``/checkpoint``.

    ``group`` : what :func:`allocate` has filled, or an earlier run.
    """

    def __init__(self, group: h5py.Group):
        file, slots = group.file, [group[name] for name in SLOTS]
        self._slots = [{name: Rows(file, f"{slot.name}/{name}") for name in slot} for slot in slots]
        self._serial = max(int(slot[SEAL][0]) for slot in slots)
        whole = [_whole_serial(slot) for slot in slots]
        self._turn = whole.index(min(whole))  # never over the newest whole one

    def write(self, state: dict) -> None:
        """Store arrays and numbers by name; raises ValueError where names or shapes change."""
        arrays, slot = _arrays(state), self._slots[self._turn]
        if slot.keys() != {*arrays, SEAL}:
            raise ValueError(f"checkpoint has {sorted(arrays)}, its file {sorted(slot)}")
        for name, array in arrays.items():
            if (slot[name].shape, slot[name].dtype) != (array.shape, array.dtype):
                raise ValueError(f"checkpoint: {name} changed its shape or type")
        for name, array in arrays.items():
            slot[name].put_all(array)
        self._serial += 1
        slot[SEAL].put_all([self._serial, checksum(self._serial, arrays)])
        self._turn = 1 - self._turn


def read_checkpoint(file: GuardedFile, committed: int) -> dict | None:
    """Return the newest state that is whole, single numbers as such, or None if there is none.

    One that has seen more frames than are committed does not count: after a power cut what was
    written last can be on the disk without what was written before it.
    """
    found = []
    for slot in (f"checkpoint/{name}" for name in SLOTS):
        try:
            serial, crc = file.array(f"{slot}/{SEAL}", "i", (2,)).tolist()
            names = [name for name in file.names(slot) if name != SEAL]
            arrays = {n: file.array(f"{slot}/{n}", "fiub", None) for n in names}
        except FileError:
            continue  # never written, or torn: that is what the other slot is for
        ahead = "frames" in arrays and not np.all(arrays["frames"] <= committed)
        if serial > 0 and checksum(serial, arrays) == crc and not ahead:
            found.append((serial, arrays))
    if not found:
        return None
    arrays = max(found, key=lambda slot: slot[0])[1]
    return {name: array if array.shape else array.item() for name, array in arrays.items()}


def checksum(serial: int, arrays: dict[str, np.ndarray]) -> int:
    """Return the CRC32 of a serial number and of names, types, shapes and bytes, by name."""
    crc = crc32(str(serial).encode())
    for name, array in sorted(arrays.items()):
        crc = crc32(f"{name} {array.dtype.str} {array.shape}".encode(), crc)
        crc = crc32(np.ascontiguousarray(array), crc)
    return crc


def _whole_serial(slot):
    """Return the serial number of a slot, 0 if it is torn or was never written."""
    serial, crc = slot[SEAL][:].tolist()
    if not serial:  # as in every new file: there is nothing to check
        return 0
    arrays = {name: data[()] for name, data in slot.items() if name != SEAL}
    return serial if checksum(serial, _arrays(arrays)) == crc else 0


def _arrays(state):
    """Return the entries as contiguous arrays, by name."""
    # ascontiguousarray alone would turn single numbers into lists of one
    return {name: np.asarray(value, order="C") for name, value in sorted(state.items())}
