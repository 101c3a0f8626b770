"""Which file a run may write: nothing is lost, and no two runs write the same file."""

from __future__ import annotations

import glob
import os
from pathlib import Path

from rodsim import kernel_locks
from rodsim.errors import FileError
from rodsim.files import has_hdf5_signature, unforeseeable
from rodsim.locks import Holder, NamedLock, holder


def real_file(path: Path) -> Path:
    """Return the file that a path stands for: where it is a link, what that leads to."""
    return Path(os.path.realpath(path)) if os.path.islink(path) else Path(path)


def check_place(path, overwrite=False) -> None:
    """Raise FileError where no output can be written: no folder, no file, or a foreign one.

    overwrite : what is there would be replaced, which only an output of a run may be.
    """
    path = Path(path)
    if not (folder := real_file(path).parent).is_dir():
        raise FileError(f"{path}: there is no folder {folder}")
    if path.exists() and not path.is_file():
        raise FileError(f"{path}: exists and is not a file")
    named_so = path.suffix in (".h5", ".hdf5")
    if overwrite and path.exists() and not named_so and not has_hdf5_signature(path):
        raise FileError(f"{path}: is no output of a run, so --overwrite does not replace it")


def free_name(path: Path) -> Path:
    """Return the next free name an existing output can be moved to: ``out.1.h5``, ``out.2.h5``."""
    number = 1
    while os.path.lexists(moved := path.with_name(f"{path.stem}.{number}{path.suffix}")):
        number += 1
    return moved


def temporary_name(path: Path) -> Path:
    """Return the name to build under; removes what killed builds left. The caller has the lock."""
    for leftover in path.parent.glob(f".{glob.escape(path.name)}.*.tmp"):
        leftover.unlink()
    return path.with_name(f".{path.name}.{unforeseeable()}.tmp")


def set_aside(path: Path) -> Path | None:
    """Rename a file that exists to the next free name; return that, or None if there is none."""
    if not os.path.lexists(path):
        return None
    moved = free_name(path)
    os.rename(path, moved)
    return moved


def take_place(built: Path, path: Path, overwrite: bool) -> Path | None:
    """Give a finished file its name; return where the output that had it went, if it was kept."""
    moved = None if overwrite else set_aside(path)
    try:
        os.replace(built, path)
    except OSError:
        if moved:
            os.rename(moved, path)
        raise
    return moved


class OutputLock:
    """A lock on an output, under any name: ``<output>.lock`` beside the real file, and the file.

    ``output`` is the name given, ``file`` the real one. The file itself is locked as well, where
    that does not keep readers out, since a hard link is a name that cannot be told from the first.
    """

    def __init__(self, output: Path):
        self.output, self.file = Path(output), real_file(output)
        self._named, self._handle = NamedLock(_lock_path(self.file)), None

    @property
    def path(self) -> Path:
        """The file that says who has the lock."""
        return self._named.path

    def acquire(self) -> None:
        """Take the lock; raises FileError that names who has it."""
        try:
            found = self._named.take()
            if found is None and not self._cover_if_there():
                self._named.release()
                found = Holder("another process, under another of its names", sure=True)
        except OSError as error:
            raise FileError(f"{self.output}: cannot be written: {error.strerror}") from error
        if found:
            advice = "" if found.sure else f"; if that has ended, remove {self.path}"
            raise FileError(f"{self.output}: is being written by {found}{advice}")

    def cover(self, file: Path) -> bool:
        """Lock this file itself, and no longer that before; False if someone else has it."""
        handle = os.open(file, os.O_RDWR)
        if kernel_locks.grab_beside_readers(handle) is False:
            os.close(handle)
            return False
        self._uncover()
        self._handle = handle
        return True

    def release(self) -> None:
        """Give the lock back, unless someone else has it by now."""
        self._uncover()
        self._named.release()

    def _cover_if_there(self):
        try:
            return not self.file.is_file() or self.cover(self.file)
        except PermissionError:
            return True  # not ours to write, so nobody like us writes it; it can still be renamed

    def _uncover(self):
        handle, self._handle = self._handle, None
        if handle is not None:
            kernel_locks.let_go(handle)


def writing_process(output: Path) -> Holder | None:
    """Return who is writing an output, ``process N on HOST`` as text, or None if nobody is."""
    return holder(_lock_path(real_file(output)))


def _lock_path(file):
    return file.with_name(file.name + ".lock")
