"""The standard streams of the command: what is said beside the results may be lost, a run not."""

from __future__ import annotations

import io
import os
import sys

STREAMS = (0, 1, 2)


class Dispensable(io.FileIO):
    """A file in which what cannot be written is dropped: a full disk, a closed terminal."""

    def write(self, data) -> int:
        """Write, or drop it."""
        try:
            return super().write(data) or len(data)  # None: would have to wait
        except OSError:
            return len(data)


def prepare_streams() -> None:
    """Let messages be lost where they cannot be written, and open the streams that are closed.

    Else the first file to be opened, the output, would get the number of a closed stream, and
    whatever a library says would be written into it.
    """
    for number in STREAMS:
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)  # gets the lowest number
    sys.stderr = _dispensable(sys.stderr)


def _dispensable(stream):
    """Return a text stream on descriptor 2 like the one that Python has made, if it has."""
    encoding = getattr(stream, "encoding", None) or "utf-8"
    buffer = io.BufferedWriter(Dispensable(2, "w", closefd=False))
    return io.TextIOWrapper(buffer, encoding, "backslashreplace", line_buffering=True)
