"""Which file a run may write: nothing is lost, and no two runs write the same file."""

import json
import os
import socket
from pathlib import Path

from rodsim.errors import FileError


def free_name(path: Path) -> Path:
    """Return the next free name for an output that has to make room: ``out.1.h5``, ..."""
    number = 1
    while (candidate := path.with_name(f"{path.stem}.{number}{path.suffix}")).exists():
        number += 1
    return candidate


class OutputLock:
    """A file ``<output>.lock`` that names the host and the process that writes the output.

    The lock of a process that has ended on this host is taken over. A process is known by its
    number and its start time, because numbers are used again.
    """

    def __init__(self, path: Path):
        self.path = path.with_name(path.name + ".lock")
        self._output = path

    def acquire(self) -> None:
        """Take the lock, or raise FileError that names who holds it."""
        mine = {"host": socket.gethostname(), "pid": os.getpid(), "started": _started(os.getpid())}
        for _ in range(3):
            try:
                handle = os.open(self.path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o644)
            except FileExistsError:
                self._clear_if_stale()
                continue
            except OSError as error:
                raise FileError(f"{self._output}: cannot write here: {error.strerror}") from error
            with os.fdopen(handle, "w") as stream:
                json.dump(mine, stream)
            return
        raise FileError(f"{self._output}: another process keeps taking {self.path.name}")

    def release(self) -> None:
        """Give the lock back."""
        self.path.unlink(missing_ok=True)

    def _clear_if_stale(self):
        try:
            holder = json.loads(self.path.read_text())
            host, pid, started = holder["host"], int(holder["pid"]), holder["started"]
        except FileNotFoundError:
            return
        except (ValueError, KeyError, TypeError, OSError) as error:
            raise FileError(
                f"{self._output}: {self.path.name} cannot be read; remove it if no run is writing"
            ) from error
        if host != socket.gethostname() or _started(pid) not in (None, started):
            alive = host != socket.gethostname()
        else:
            alive = _started(pid) is not None or (started is None and _exists(pid))
        if alive:
            raise FileError(
                f"{self._output}: process {pid} on host {host} is writing this file; "
                f"if it is gone, remove {self.path.name}"
            )
        self.path.unlink(missing_ok=True)


def _exists(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True


def _started(pid):
    """Return the start time of a process in clock ticks since boot, None if it cannot be told."""
    try:
        stat = Path(f"/proc/{pid}/stat").read_text()
    except OSError:
        return None
    return int(stat.rpartition(")")[2].split()[19])
