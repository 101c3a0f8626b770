"""One run on the machine this is called on: what is left of it, done by a command of its own."""

from __future__ import annotations

import os
import shlex
import subprocess
from time import monotonic, sleep

from rodsim.errors import FileError, StoppedError
from rodsim.processes import this_rodsim
from rodsim.sweep.plan import Run

DONE = ("finished", "diverged")
PATIENCE = 180.0  # s without a write after which whoever has an output is taken for gone
_running: list[tuple[str, subprocess.Popen]] = []  # (sweep, its run), of this process
_stopped: set[str] = set()  # sweeps that want no more runs


def standing(run: Run) -> str:
    """Return ``finished``, ``diverged``, ``stopped`` (can be resumed) or ``waiting``.

    Read from the output file, which counts only if its resolved case is that of the run.
    """
    from rodsim.output import open_trajectory

    try:
        with open_trajectory(run.output) as output:
            if output.case_data() != run.data:
                return "waiting"
            if output.status in DONE:
                return output.status
            return "waiting" if output.checkpoint() is None else "stopped"
    except (FileError, ValueError):
        return "waiting"


def command(run: Run, stands: str) -> list[str]:
    """Return the command that does what is left of a run."""
    if stands == "stopped":
        return [*this_rodsim(), "resume", str(run.output)]
    return [*this_rodsim(), "run", str(run.case), "-o", str(run.output)]


def work(sweep: str, run: Run, threads: int | None) -> int:
    """Do a run from where it stands; return the exit code of its command.

    Whatever happened to an earlier call for the same run, this one goes on from its file. If the
    command that call had started still lives, it is left to end.
    """
    _wait_until_free(run.output)
    stands = standing(run)
    if stands in DONE:
        return 0
    if sweep in _stopped:
        return StoppedError.exit_code
    return _execute(sweep, run, command(run, stands), threads)


def stop(sweep: str) -> None:
    """Ask the runs of a sweep that this process has started to stop where they are, each once.

    SIGTERM and not SIGINT: one that comes while a run is still starting ends it, too.
    """
    _stopped.add(sweep)
    for entry in [entry for entry in _running if entry[0] == sweep]:
        _running.remove(entry)
        entry[1].terminate()


def _execute(sweep, run, line, threads):
    environment = {"NUMBA_NUM_THREADS": "1", **os.environ}  # a thread of Dask stands for a core
    if threads:
        environment["NUMBA_NUM_THREADS"] = str(threads)
    with run.log.open("a", encoding="utf-8") as log:
        log.write(f"$ {shlex.join(line)}\n")
        log.flush()
        # A session of its own: Ctrl-C on the terminal reaches the sweep, which then stops the runs.
        process = subprocess.Popen(
            line, stdin=subprocess.DEVNULL, stdout=log, stderr=log, env=environment,
            start_new_session=True,
        )  # fmt: skip
        _running.append((sweep, process))
        try:
            return process.wait()
        finally:
            if (sweep, process) in _running:
                _running.remove((sweep, process))


def _wait_until_free(output):
    """Wait while another process writes the output; give up on one that writes no more."""
    from rodsim.output.paths import writing_process

    seen, since = None, monotonic()
    while writing_process(output):
        now = output.stat().st_mtime if output.exists() else None
        if now != seen:
            seen, since = now, monotonic()
        if monotonic() - since > PATIENCE:
            return  # the command will say who has it
        sleep(0.2)
