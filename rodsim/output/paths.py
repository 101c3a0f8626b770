"""Which file a run may write: nothing is lost, and no two runs write the same file."""

from __future__ import annotations

import glob
import json
import os
import socket
from pathlib import Path

from rodsim.errors import FileError


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
    return path.with_name(f".{path.name}.{os.getpid()}.tmp")


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
    """A file ``<output>.lock`` that names the host and process writing the output.

    The lock of a process that has ended on this host is taken over. A process is recognised by
    its number and, where /proc tells it, its start time: numbers are used again.
    """

    def __init__(self, output: Path):
        self.output = output
        self.path = output.with_name(output.name + ".lock")
        pid = os.getpid()
        owner = {"host": socket.gethostname(), "pid": pid, "started": _process(pid)[1]}
        self._text = json.dumps(owner)

    def acquire(self) -> None:
        """Take the lock; raises FileError that names who has it."""
        try:
            if not self._create():
                self._remove_stale()
                if not self._create():
                    raise FileError(f"{self.output}: another run has just started to write it")
        except OSError as error:
            raise FileError(f"{self.output}: cannot be written: {error.strerror}") from error

    def release(self) -> None:
        """Give the lock back, unless someone else has it by now."""
        try:
            if self.path.read_text() == self._text:
                self.path.unlink()
        except (OSError, ValueError):
            pass  # gone or not ours: nothing to give back

    def _create(self):
        try:
            handle = os.open(self.path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o644)
        except FileExistsError:
            return False
        with os.fdopen(handle, "w") as stream:
            stream.write(self._text)
        return True

    def _remove_stale(self):
        try:
            found = self.path.read_text(errors="replace")
        except FileNotFoundError:
            return  # given back since
        self._refuse_if_alive(found)
        # Renaming can succeed for one process only, so two cannot both take over the same lock.
        aside = self.path.with_name(f"{self.path.name}.{os.getpid()}")
        try:
            os.rename(self.path, aside)
        except FileNotFoundError:
            return
        if aside.read_text(errors="replace") != found:  # taken over between our two looks
            os.rename(aside, self.path)
            return
        aside.unlink()

    def _refuse_if_alive(self, found):
        try:
            host, pid, started = _owner(found)
        except ValueError:
            raise FileError(
                f"{self.output}: its lock cannot be read; if no run writes it, remove {self.path}"
            ) from None
        if not _is_alive(host, pid, started):
            return
        raise FileError(
            f"{self.output}: is being written by process {pid} on {host}; "
            f"if that has ended, remove {self.path}"
        )


def writing_process(output: Path) -> str:
    """Return ``process N on HOST`` of who is writing an output, empty if nobody is."""
    lock = OutputLock(Path(output))
    try:
        owner = _owner(lock.path.read_text())
    except (OSError, ValueError):
        return ""
    return f"process {owner[1]} on {owner[0]}" if _is_alive(*owner) else ""


def _owner(text):
    """Return host, number and start of the process that has written a lock; or ValueError."""
    try:
        owner = json.loads(text)
        return str(owner["host"]), int(owner["pid"]), owner["started"]
    except (KeyError, TypeError, RecursionError) as error:
        raise ValueError("not a lock") from error


def _is_alive(host, pid, started):
    """Tell whether a process runs; of one on another host nothing is known: it may."""
    if host != socket.gethostname():
        return True
    alive, since = _process(pid)
    return alive and (None in (started, since) or started == since)


def _process(pid):
    """Return whether a process runs, and its start in clock ticks since boot where that is told."""
    try:
        state, *numbers = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        return state not in "ZX", int(numbers[18])
    except (OSError, ValueError, IndexError):
        pass
    try:
        os.kill(pid, 0)
    except (ProcessLookupError, OverflowError):
        return False, None
    except PermissionError:
        pass
    return True, None
