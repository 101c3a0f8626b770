"""Compiles the kernels of a scene ahead of its run, in a process of its own.

Code that Numba has just compiled and the same code read from its cache can differ in the last bit
of a sum (the parallel part is optimised once more when it is linked). A run must not depend on
whether it was the first, so the command never runs what it compiles: it reads it from the cache.

A cache that a full disk, a power cut or a stray hand has damaged would crash Numba. The list of
what was compiled holds the checksum of every file; where one does not fit, all is compiled anew.
"""

import gc
import json
import os
import sys
import tempfile
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from time import perf_counter
from zlib import crc32

from rodsim.compiled.folder import alone
from rodsim.compiled.kernels import jit_is_off
from rodsim.compiled.parts import TRACERS
from rodsim.compiled.settings import fingerprint, why_not_kept
from rodsim.processes import this_rodsim
from rodsim.progress import SECONDS_BETWEEN_LINES

LIST, LOCK = "compiled.json", "lock"
# What every run needs beside its parts. Who imports the second compiles it all; the others are
# large pieces, in an order that lets two processes come at none of them together.
MACHINE = (
    "rodsim.scene.loop:velocities_at",
    "rodsim.run.machine",
    "rodsim.scene.stages",
    "rodsim.scene.gap",
    "rodsim.compiled.rotations",
)
BACKWARDS = "--backwards"


def ensure_compiled(scene, say, flow: bool = False) -> float:
    """Compile what ``scene`` needs if this installation has not yet; return the seconds it took.

    ``say`` is called with a line for the user before the wait. ``flow`` : the velocity of the fluid
    is wanted though no tracer is in it.
    """
    flow = flow or scene.initial.tracer.size
    parts = scene.parts if flow else scene.parts.without(TRACERS)
    needed = ((part.where, *part.sums, *part.needs) for part in parts)
    return ensure({where for found in needed for where in found}, say, "this kind of scene")


def ensure(names, say, what: str) -> float:
    """Compile kernels ``module:name``, and what modules compile when they are imported.

    Call after ``settings.prepare``. ``what`` they are for is said before the wait. Of several
    processes that come at once one compiles, and the others wait for it. Returns the seconds.
    """
    if jit_is_off():
        return 0.0
    reason = why_not_kept()
    how = f"as at every run, for nothing can be kept ({reason})" if reason else "once"
    compiling = f"compiling for {what}, {how}; some seconds"
    if "NUMBA_CACHE_DIR" not in os.environ:  # no folder at all: the run itself compiles
        say(compiling)
        return 0.0
    folder, names = Path(os.environ["NUMBA_CACHE_DIR"]), sorted(names)
    # A folder that the user has set can be shared by several versions and installations.
    kind = "-".join((fingerprint(), *names))
    if is_compiled(folder, kind):
        return 0.0
    say(compiling)
    start = perf_counter()
    with suppress(OSError), alone(folder / LOCK):  # where nothing can be kept, the run compiles
        if not is_compiled(folder, kind):
            if _is_ours(folder, kind) and not _undamaged(folder):
                _clear(folder)
            why = _compile_apart(folder, names, say)
            if not why:
                note_compiled(folder, kind)
            else:
                say(f"that failed, so the run itself compiles, now and every time: {why}")
    return perf_counter() - start


def _compile_apart(folder, names, say):
    """Run ``main`` in a process of its own; say how far it is; return why it failed, if it did."""
    import subprocess  # what is compiled already has no use for it

    start, there = perf_counter(), _functions(folder)
    pipes = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
    command = [*this_rodsim("rodsim.run.warmup"), *names]
    with subprocess.Popen(command, **pipes, text=True) as process:
        try:
            while process.poll() is None:
                with suppress(subprocess.TimeoutExpired):
                    process.wait(SECONDS_BETWEEN_LINES)
                    break
                new = _functions(folder) - there
                say(f"compiled {new} functions in {perf_counter() - start:.0f} s, going on")
            errors = process.stderr.read().strip()
        except BaseException:
            process.terminate()
            raise
    if process.returncode:
        return errors.rpartition("\n")[2] or f"exit code {process.returncode}"
    return ""


def _functions(folder):
    return sum(1 for _ in folder.rglob("*.nbc"))


def is_compiled(folder: Path, kind: str) -> bool:
    """Tell whether all that a kind of scene needs is listed as compiled, and files as they were.

    It may have been compiled for several other kinds of this installation.
    """
    whole = not _is_ours(folder, kind) or _undamaged(folder)
    ours, *needed = kind.split("-")
    kinds = [listed.split("-") for listed in _listed(folder)["kinds"]]
    there = [names for installation, *names in kinds if installation == ours]
    return whole and bool(there) and set().union(*there).issuperset(needed)


def note_compiled(folder: Path, kind: str) -> None:
    """List a kind of scene as compiled, and every file of compiled code with its checksum."""
    kinds = {*_listed(folder)["kinds"], kind}
    codes = folder.rglob("*.nbc") if _is_ours(folder, kind) else ()
    files = {str(f.relative_to(folder)): crc32(f.read_bytes()) for f in codes}
    text = json.dumps({"kinds": sorted(kinds), "files": files})
    with tempfile.NamedTemporaryFile("w", dir=folder, prefix=LIST, delete=False) as new:
        new.write(text)  # under a name that nobody can guess, so no link can be waiting there
    os.replace(new.name, folder / LIST)


def _is_ours(folder, kind):
    """Tell a folder of this installation from one that the user has set, for whatever else."""
    return kind.startswith(f"{folder.name}-")


def _listed(folder):
    try:
        found = json.loads((folder / LIST).read_text())
        return {"kinds": list(found["kinds"]), "files": dict(found["files"])}
    except (OSError, ValueError, KeyError, TypeError):
        return {"kinds": [], "files": {}}


def _undamaged(folder):
    """Check the listed files; an index changes with every new kernel, but is a whole pickle."""
    try:
        listed = _listed(folder)["files"].items()
        whole = all(crc32((folder / name).read_bytes()) == crc for name, crc in listed)
        return whole and all(f.read_bytes().endswith(b".") for f in folder.rglob("*.nbi"))
    except OSError:
        return False


def _clear(folder):
    for pattern in (LIST, "*.nbi", "*.nbc"):
        for file in folder.rglob(pattern):
            file.unlink(missing_ok=True)


def main(names) -> None:
    """Fill the cache with what every run needs, and with the parts of one kind of scene.

    In two processes, which begin at the two ends of the list: one with the parts, the other with
    the rest. What one has compiled, the other finds in the cache, and when the first is through,
    so is the list.
    """
    import signal
    import subprocess

    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that the helper is stopped too
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    command = [*this_rodsim("rodsim.run.warmup"), BACKWARDS, *names]
    with subprocess.Popen(command, **quiet) as helper:
        try:
            _compile([*names, *MACHINE])
        finally:
            helper.kill()


def _compile(names):
    """Compile kernels ``module:name``, or what comes with the import of a module."""
    from rodsim.compiled.settings import prepare

    gc.disable()  # a twentieth of the time, for 30 MB
    prepare()
    from rodsim.compiled.kernels import address_of

    for name in names:
        address_of(name) if ":" in name else import_module(name)


if __name__ == "__main__":
    if BACKWARDS in sys.argv[1:2]:
        _compile([*MACHINE[::-1], *sys.argv[:1:-1]])
    else:
        main(sys.argv[1:])
