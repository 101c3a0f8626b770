"""A lock with a name: a file that says who has it, locked by the system while that is true.

What counts is the system's lock, not what the file says: one that is empty (a full disk), or names
a process that has ended, or one that never ran here, is free as soon as nobody holds it. Only
where the file system has no locks, or the file names another machine, must its words be believed.
"""

from __future__ import annotations

import errno
import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from rodsim import kernel_locks
from rodsim.files import unforeseeable
from rodsim.processes import Process, this_process

LONGEST = 4096  # bytes of a lock that are read
LOOKS = 100  # at a lock that others take and give back between our looks
NOT_THROUGH_LINKS = getattr(os, "O_NOFOLLOW", 0)


@dataclass(frozen=True)
class Holder:
    """Who has a lock. ``sure``: the system says so; otherwise only the lock's own words do."""

    who: str
    sure: bool

    def __str__(self) -> str:
        return self.who


class NamedLock:
    """A lock of this process on a name. ``take`` and ``release``, each harmless if done twice."""

    def __init__(self, path: Path):
        self.path, self._handle = Path(path), None

    def take(self) -> Holder | None:
        """Take the lock if it is free, else return who has it. Raises OSError if it cannot be."""
        for _ in range(LOOKS):
            if self._handle is not None:
                return None
            opened = self._open()
            found = self._try(*opened) if opened else None
            if found:
                return found
        return Holder("other processes, in turn", sure=True)

    def release(self) -> None:
        """Give the lock back, unless someone else has it by now."""
        handle, self._handle = self._handle, None
        if handle is None:
            return
        with suppress(OSError):
            if self._is_at_name(handle) and _text(handle) == this_process().text():
                self.path.unlink()
        kernel_locks.let_go(handle)

    def _open(self):
        """Return the open file of the lock and whether it is new; None where it has just gone."""
        flags = os.O_RDWR | NOT_THROUGH_LINKS
        try:
            return os.open(self.path, flags | os.O_CREAT | os.O_EXCL, 0o644), True
        except FileExistsError:
            with suppress(FileNotFoundError):
                return os.open(self.path, flags), False
        return None

    def _try(self, handle, made):
        """Lock an open file and keep it, or return who has it, or None to look again."""
        held = kernel_locks.grab(handle)
        owner = Process.parse(_text(handle))
        if held is False or not (made or _is_free(owner, held)):
            kernel_locks.let_go(handle)
            return Holder(str(owner or "another process"), sure=held is False)
        if held is None and not made:
            kernel_locks.let_go(handle)
            return self._remove_stale(owner)
        if not self._is_at_name(handle):  # its last owner has removed it before we had it
            kernel_locks.let_go(handle)
            return None
        self._sign(handle)
        return None

    def _sign(self, handle):
        """Write who we are; a lock that cannot be written is none, and no trace of it stays."""
        self._handle = handle
        try:
            os.ftruncate(handle, 0)
            text = this_process().text().encode()
            if os.pwrite(handle, text, 0) < len(text):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        except OSError:
            self._handle = None
            self.path.unlink(missing_ok=True)
            kernel_locks.let_go(handle)
            raise

    def _is_at_name(self, handle):
        with suppress(FileNotFoundError):
            return os.path.samestat(os.fstat(handle), os.lstat(self.path))
        return False

    def _remove_stale(self, owner):
        """Remove a stale lock where the system has none: of two who try, only one can rename it."""
        aside = self.path.with_name(f"{self.path.name}.{unforeseeable()}")
        try:
            os.rename(self.path, aside)
        except FileNotFoundError:
            return None
        now = Process.parse(aside.read_text(errors="replace"))
        if now != owner:  # taken over between our two looks
            os.rename(aside, self.path)
            return Holder(str(now or "another process"), sure=False)
        aside.unlink()
        return None


def holder(path) -> Holder | None:
    """Return who has the lock of a name, or None if nobody has; changes nothing."""
    try:
        handle = os.open(path, os.O_RDONLY | NOT_THROUGH_LINKS)
    except OSError:
        return None
    try:
        held = kernel_locks.grabbed(handle)
        owner = Process.parse(_text(handle))
    finally:
        os.close(handle)
    if held or not _is_free(owner, held):
        return Holder(str(owner or "another process"), sure=bool(held))
    return None


def _is_free(owner, held):
    """Tell whether a lock may be taken over that the system gives us, or has no lock for.

    One of another machine may not: on a network file system its lock may be invisible here.
    """
    if held is None:
        return owner is not None and not owner.alive
    return owner is None or owner.here


def _text(handle):
    return os.pread(handle, LONGEST, 0).decode(errors="replace")
