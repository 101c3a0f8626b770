"""One run on the machine this is called on: what is left of it, as a command that a worker does."""

from __future__ import annotations

import os
import shlex
from contextlib import suppress
from time import monotonic, sleep

from rodsim.errors import FileError, StoppedError
from rodsim.locks import NamedLock
from rodsim.output.paths import writing_process
from rodsim.processes import this_rodsim
from rodsim.sweep import workers
from rodsim.sweep.plan import Run
from rodsim.sweep.standing import DONE, standing

PATIENCE = 180.0  # s without a write after which one who may have gone is taken for gone
POLL_SECONDS = 0.2
STOPPED = StoppedError.exit_code, ""
_stopped: set[str] = set()  # sweeps that want no more runs
_begun: set[tuple[str, str]] = set()  # (sweep, name of a run) that this process is at


def command(run: Run, stands: str) -> list[str]:
    """Return the command that does what is left of a run."""
    return [*this_rodsim(), *_arguments(run, stands)]


def _arguments(run, stands):
    if run.verb != "run":  # nothing that could be resumed
        return [run.verb, str(run.case), "-o", str(run.output), *run.options]
    if stands in ("stopped", "running"):
        return ["resume", str(run.output)]
    return ["run", str(run.case), "-o", str(run.output)]


def work(sweep: str, run: Run, threads: int | None, alone: bool = False) -> tuple[int, str]:
    """Do a run from where it stands; return the exit code of its command and its last line.

    ``alone``: in a process of its own; otherwise by one of the workers of the sweep.

    Whatever happened to an earlier call for the same run, this one goes on from its file. While
    another process does this run, a worker of another sweep or a command by hand, it is waited
    for, and what that has done is not done again.
    """
    if sweep in _stopped:
        return STOPPED
    lock, entry = NamedLock(run.lock), (sweep, run.name)
    _begun.add(entry)
    try:
        run.folder.mkdir(parents=True, exist_ok=True)
        ended = _wait_while(lock.take, sweep, run) or _do(sweep, run, threads, alone)
    finally:
        lock.release()
        _begun.discard(entry)
    return ended


def _do(sweep, run, threads, alone):
    while True:
        ended = _wait_while(lambda: writing_process(run.output), sweep, run)
        if ended:
            return ended
        stands = standing(run)
        if stands in DONE:
            return 0, ""
        if sweep in _stopped:
            return STOPPED
        run.prepare()  # another sweep in this folder may have had another case
        code, said = _execute(sweep, run, stands, threads, alone)
        if code != FileError.exit_code or not writing_process(run.output):
            return code, said  # else someone was faster: that is waited for


def stop(sweep: str) -> list[str]:
    """Ask the runs of a sweep that this process has started to stop where they are, each once.

    Returns the names of the runs that it is still at; it begins no more of them.
    """
    _stopped.add(sweep)
    workers.stop(sweep)
    return [name for of, name in list(_begun) if of == sweep]


def _execute(sweep, run, stands, threads, alone):
    with _log(run) as log:
        begin = _size(log)
        with suppress(OSError):  # a full disk: a log can be done without
            os.write(log.fileno(), f"$ {shlex.join(command(run, stands))}\n".encode())
        code = workers.do(sweep, threads, _arguments(run, stands), log, alone)
        return code, last_line(run.log, since=begin)


def _log(run):
    try:
        return run.log.open("ab", buffering=0)
    except OSError:
        return open(os.devnull, "ab", buffering=0)


def _size(log):
    return os.fstat(log.fileno()).st_size


def _wait_while(look, sweep, run):
    """Wait while ``look`` says that someone has it; return how the run ends if that is in vain.

    The word of the system is believed. Whoever only may have it, on another machine, is given up
    on where nothing is written any more.
    """
    seen, since = None, monotonic()
    while found := look():
        if sweep in _stopped:
            return STOPPED
        now = run.output.stat().st_mtime if run.output.exists() else None
        if now != seen:
            seen, since = now, monotonic()
        if not found.sure and monotonic() - since > PATIENCE:
            return FileError.exit_code, _in_vain(run, found)
        sleep(POLL_SECONDS)
    return None


def _in_vain(run, found):
    locks = [str(run.lock), f"{run.output}.lock"]
    return f"is being done by {found}; if that has ended, remove {' and '.join(locks)}"


def last_line(log, start: str = "", since: int = 0) -> str:
    """Return the last line of a log that is not empty and begins so, or nothing.

    ``since`` : bytes of the log that are of earlier commands.
    """
    try:
        with log.open("rb") as stream:
            stream.seek(since)
            lines = stream.read().decode(errors="replace").split("\n")
    except OSError:
        return ""
    return next((line for line in reversed(lines) if line.strip() and line.startswith(start)), "")
