"""What kind of file a path is, told without the library that would read it; whole files."""

import errno
import os
from contextlib import contextmanager
from pathlib import Path

from rodsim.errors import FileError

DEFAULT_OUTPUT = "out.h5"
LONGEST_NAME = 200  # others are made of it: of the lock, of the file while it is built
HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def shipped(name: str) -> Path:
    """Return the path of what lies beside the package in a checkout, and inside it in a wheel."""
    inside = Path(__file__).parent / name
    return inside if inside.exists() else inside.parent.parent / name


def has_hdf5_signature(path: Path) -> bool:
    """Return whether a file begins as HDF5 files do; raises OSError if it cannot be read."""
    with path.open("rb") as stream:
        return stream.read(len(HDF5_SIGNATURE)) == HDF5_SIGNATURE


def reason_of(error: Exception) -> str:
    """Return the system's words for why a file cannot be written, and not those of HDF5."""
    number = getattr(error, "errno", None)
    if number == errno.ENAMETOOLONG:
        return f"its name is too long, use at most {LONGEST_NAME} characters"
    return os.strerror(number) if number else str(error)


def unforeseeable() -> str:
    """Return letters for the name of a file that nobody else can have thought of."""
    return os.urandom(8).hex()


@contextmanager
def replacing(path):
    """Give a name beside ``path`` to write to; in the end that file takes its place, whole.

    Where the block fails or is interrupted, nothing of it is left and what was there stays.
    Raises FileError where that is impossible, and rather than replace the output of a run.
    """
    path = Path(path)
    if _is_output(path):
        raise FileError(f"{path}: is the output of a run, not replaced; give another name")
    temporary = path.with_name(f".{path.stem}.{unforeseeable()}{path.suffix}")
    try:
        # Made here, so that a file or link that someone else has put there is never written to.
        os.close(os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        yield temporary
        os.replace(temporary, path)
    except OSError as error:
        raise FileError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        temporary.unlink(missing_ok=True)


def _is_output(path):
    try:
        if not has_hdf5_signature(path):
            return False
        import h5py

        with h5py.File(path, "r", locking=False) as file:
            return "committed" in file and "case" in file
    except (OSError, RuntimeError):
        return False
