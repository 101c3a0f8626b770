"""Locks the system keeps on open files: they end with their process, however it ends.

Where there are locks of open file descriptions (Linux), these are used and not ``flock``: HDF5
asks for flock on whatever it opens, so a run that held it would lock ParaView out of its output.
They are seen from other containers on the same machine, and cannot be lost by closing another
descriptor of the same file. Elsewhere it is ``flock``.
"""

from __future__ import annotations

import errno
import os
import struct

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None

OWN_KIND = hasattr(fcntl, "F_OFD_SETLK")  # of locks, apart from flock
_BUSY = (errno.EAGAIN, errno.EACCES)
_NONE_HERE = (errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOLCK, errno.EINVAL)  # on this file system


def grab(handle: int) -> bool | None:
    """Lock an open file; False if someone else has it locked, None where there are no locks."""
    return _answered(lambda: _set(handle, "F_WRLCK"))


def grab_beside_readers(handle: int) -> bool | None:
    """Do as ``grab``, but give it up again where it would keep HDF5's readers out (as on NFS)."""
    if not OWN_KIND:
        return None
    got = grab(handle)
    if got and not _readable(handle):
        _set(handle, "F_UNLCK")
        return None
    return got


def grabbed(handle: int) -> bool | None:
    """Tell whether someone else has an open file locked; None where there are no locks."""
    if OWN_KIND:
        return _answered(lambda: not _free(handle))
    got = _answered(lambda: fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB))
    if got:
        fcntl.flock(handle, fcntl.LOCK_UN)
    return None if got is None else not got


def let_go(handle: int) -> None:
    """Unlock and close, also where a forked process still has the file open."""
    if fcntl is not None:
        _answered(lambda: _set(handle, "F_UNLCK"))
    os.close(handle)


def _set(handle, kind):
    if OWN_KIND:
        fcntl.fcntl(handle, fcntl.F_OFD_SETLK, _whole_file(kind))
    else:
        flag = fcntl.LOCK_EX if kind == "F_WRLCK" else fcntl.LOCK_UN
        fcntl.flock(handle, flag | fcntl.LOCK_NB)


def _free(handle):
    found = fcntl.fcntl(handle, fcntl.F_OFD_GETLK, _whole_file("F_WRLCK"))
    return struct.unpack("hhqqi", found)[0] == fcntl.F_UNLCK


def _whole_file(kind):
    return struct.pack("hhqqi", getattr(fcntl, kind), os.SEEK_SET, 0, 0, 0)


def _readable(handle):
    """Tell whether another open file of this name can have flock, as HDF5 wants it for reading."""
    try:
        other = os.open(f"/proc/self/fd/{handle}", os.O_RDONLY)
    except OSError:
        return True
    try:
        return _answered(lambda: fcntl.flock(other, fcntl.LOCK_SH | fcntl.LOCK_NB)) is not False
    finally:
        os.close(other)


def _answered(ask):
    """Return what a call says (None counts as True), False for busy, None where it cannot be."""
    if fcntl is None:
        return None
    try:
        said = ask()
    except OSError as error:
        if error.errno in _BUSY:
            return False
        if error.errno in _NONE_HERE:
            return None
        raise
    return True if said is None else said
