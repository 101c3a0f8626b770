"""A process that does one command after another: what they need is imported and loaded once.

``python -m rodsim.commands.serve`` takes orders from its standard input, each a line of JSON: the
arguments of a command, and the file that gets all it says. Its exit code goes back on standard
output. Where the input ends, whoever gave the orders is gone: the command stops after its step.
"""

from __future__ import annotations

import json
import os
import queue
import sys
import threading
import traceback
from contextlib import contextmanager, suppress

from rodsim import cli
from rodsim.run.stopping import stop_all
from rodsim.starting import start_quickly
from rodsim.streams import prepare_streams
from rodsim.sweep.workers import IDLE

IDLE_SECONDS = 60.0  # after which a process without orders ends: who gave them can be out of reach


def main() -> int:
    """Do what is ordered until nothing comes any more; return the exit code of this process."""
    start_quickly()
    prepare_streams()
    orders, answers = os.fdopen(os.dup(0), "rb", buffering=0), os.dup(1)
    _point(os.devnull, 0, 1)
    waiting: queue.SimpleQueue = queue.SimpleQueue()
    threading.Thread(target=_hear, args=(orders, waiting), daemon=True).start()
    while True:
        try:
            order = waiting.get(timeout=IDLE_SECONDS)
        except queue.Empty:
            return IDLE
        if order is None:
            return 0
        code = _do(*order)
        if _has_lost_a_file():
            os._exit(code)  # HDF5 would try again to write what did not fit, see __main__
        with suppress(BrokenPipeError):
            os.write(answers, f"{code}\n".encode())


def _hear(orders, waiting):
    for line in orders:
        waiting.put(json.loads(line))
    stop_all("the end of the sweep that started it")
    waiting.put(None)


def _do(arguments, log):
    """Do a command as a process of its own would; return its exit code."""
    with _saying_to(log):
        try:
            cli.main(arguments, prog_name="rodsim")
        except SystemExit as end:
            return end.code or 0
        except Exception:
            traceback.print_exc()
    return 1


@contextmanager
def _saying_to(log):
    """Let both output streams go to the end of a file, also what libraries write."""
    try:
        _point(log, 1, 2)
    except OSError:  # a full disk: a log can be done without
        _point(os.devnull, 1, 2)
    try:
        yield
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        _point(os.devnull, 1, 2)


def _point(path, *streams):
    handle = os.open(path, os.O_RDWR | os.O_APPEND | os.O_CREAT, 0o666)
    for stream in streams:
        os.dup2(handle, stream)
    os.close(handle)


def _has_lost_a_file():
    writer = sys.modules.get("rodsim.output.writer")
    return bool(writer and writer.abandoned)


if __name__ == "__main__":
    sys.exit(main())
