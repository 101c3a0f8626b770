"""A folder for compiled code into which nobody else can put code: what lies there is executed."""

import errno
import os
import tempfile
from contextlib import contextmanager, suppress
from pathlib import Path

OTHERS_MAY_WRITE = 0o022


def private_folder(folder: Path) -> Path:
    """Return the folder, made if need be, once it and the one above are seen to be ours alone.

    Raises OSError where it cannot be written, belongs to someone else, or others may write it.
    """
    with suppress(FileExistsError):
        folder.parent.mkdir(mode=0o700, parents=True)
    mode = _mode_of_ours(folder.parent)
    if mode & OTHERS_MAY_WRITE:  # what others have put there so far is seen by its owner
        folder.parent.chmod(mode & ~OTHERS_MAY_WRITE)
    with suppress(FileExistsError):
        folder.mkdir(mode=0o700)
    if _mode_of_ours(folder) & OTHERS_MAY_WRITE:
        raise PermissionError(errno.EPERM, "others may write it, so it is not used", str(folder))
    return writable_folder(folder)


def writable_folder(folder: Path) -> Path:
    """Return the folder, made if need be; raises OSError where nothing can be written to it."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=folder):
        return folder


@contextmanager
def alone(lock: Path):
    """Hold a lock that the system takes back should this process die; none where it has none.

    Raises OSError where the file cannot be written, or is a link that waits under its name.
    """
    lock.parent.mkdir(parents=True, exist_ok=True)
    flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)
    with os.fdopen(os.open(lock, flags, 0o600), "w") as held:
        with suppress(ImportError, OSError):
            import fcntl

            fcntl.flock(held, fcntl.LOCK_EX)
        yield


def _mode_of_ours(folder):
    """Return the mode of a folder; PermissionError where it is not our own."""
    found = folder.stat()
    if hasattr(os, "geteuid") and found.st_uid != os.geteuid():
        raise PermissionError(errno.EPERM, "belongs to another user", str(folder))
    return found.st_mode & 0o777 if hasattr(os, "geteuid") else 0o700
