"""What kind of file a path is, told without the library that would read it."""

from pathlib import Path

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def has_hdf5_signature(path: Path) -> bool:
    """Return whether a file begins as HDF5 files do; raises OSError if it cannot be read."""
    with path.open("rb") as stream:
        return stream.read(len(HDF5_SIGNATURE)) == HDF5_SIGNATURE
