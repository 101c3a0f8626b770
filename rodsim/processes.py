"""Processes: starting this very rodsim in another one, and telling one from all others."""

from __future__ import annotations

import json
import os
import socket
import sys
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path

import rodsim

GROUPS = Path("/sys/fs/cgroup")
QUOTAS = ("cpu.max", "cpu/cpu.cfs_quota_us cpu/cpu.cfs_period_us")  # of the two versions of them


def this_rodsim(module: str = "rodsim") -> list[str]:
    """Return the command that runs a module of the rodsim that is running now.

    ``python -m`` looks into the current folder first, where another copy can lie: the source that
    this one was installed from.
    """
    root = str(Path(rodsim.__file__).parent.parent)
    safe = ["-P"] if root in sys.path[1:] else []  # sys.path[0] is the folder that -P leaves out
    return [sys.executable, *safe, "-m", module]


def usable_cores(groups: Path = GROUPS) -> int:
    """Return how many cores this process may use: those it may run on, and what a container has.

    A container's share is a quota of time in each period, told in the files of its control group.
    """
    may_run_on = getattr(os, "sched_getaffinity", None)
    cores = len(may_run_on(0)) if may_run_on else os.cpu_count() or 1
    for names in QUOTAS:
        with suppress(OSError, ValueError):  # not there; "max", no limit
            texts = [(groups / name).read_text() for name in names.split()]
            quota, period = map(int, " ".join(texts).split())
            if quota > 0 and period > 0:
                cores = min(cores, -(-quota // period))
    return max(1, cores)


@dataclass(frozen=True)
class Process:
    """A process, as it is named to others.

    ``boot`` is the run of the machine since it was started, the same in all its containers;
    ``space`` the container that ``pid`` counts in; ``started`` in clock ticks since boot: numbers
    are used again. What a system does not tell is None.
    """

    host: str
    pid: int
    started: int | None = None
    boot: str | None = None
    space: str | None = None

    @classmethod
    def parse(cls, text: str) -> Process | None:
        """Return the process that ``text()`` has named, or None if it is nothing of the kind."""
        try:
            found = json.loads(text)
            given = {name: found.get(name) for name in ("started", "boot", "space")}
            return cls(str(found["host"]), int(found["pid"]), **given)
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            return None

    def text(self) -> str:
        """Return one line of JSON."""
        return json.dumps(asdict(self))

    def __str__(self) -> str:
        inside = self.here and self.space not in (None, this_process().space)
        return f"process {self.pid} on {self.host}" + (", in another container" if inside else "")

    @property
    def here(self) -> bool:
        """Whether it is, or was, on this machine: its name can be another in a container."""
        return self.host == this_process().host or self.boot == (this_process().boot or "")

    @property
    def alive(self) -> bool:
        """Whether it runs, or may: of other machines and containers nothing is known."""
        me = this_process()
        if not self.here:
            return True
        if None not in (self.boot, me.boot) and self.boot != me.boot:
            return False
        if None not in (self.space, me.space) and self.space != me.space:
            return True
        runs, since = _look(self.pid)
        return runs and (None in (self.started, since) or self.started == since)


def this_process() -> Process:
    """Return the process that asks."""
    return _this_process(os.getpid())  # another one after a fork


@cache
def _this_process(pid):
    boot = _read("/proc/sys/kernel/random/boot_id")
    return Process(socket.gethostname(), pid, _look(pid)[1], boot, _space())


def _read(path):
    try:
        return Path(path).read_text().strip() or None
    except OSError:
        return None


def _space():
    try:
        return os.readlink("/proc/self/ns/pid")
    except OSError:
        return None


def _look(pid):
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
