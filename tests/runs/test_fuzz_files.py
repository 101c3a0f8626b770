"""Damaged HDF5 files: each is refused in one line, or read; none ends a command otherwise.

Files are read in processes of their own, some hundred in each, so that a crash inside HDF5 would
show and be counted. ``RODSIM_FILES`` sets the number of files of the long test.
"""

import os
import signal
import subprocess
import sys
from collections import Counter

import pytest
from outputs import create, write

BATCH = 250
READER = """
import signal, sys
from pathlib import Path
import numpy as np
np.seterr(all="ignore")
from fuzz import damaged
from rodsim.errors import FileError
from rodsim.commands.stored_run import check_output, describe_output

good, path = Path(sys.argv[1]).read_bytes(), Path(sys.argv[2])
for seed in range(int(sys.argv[3]), int(sys.argv[4])):
    print(seed, end=" ", flush=True)
    path.write_bytes(damaged(good, seed))
    signal.alarm(10)  # a hang ends the process
    fates = []
    for read in (check_output, describe_output):
        try:
            read(path)
            fates.append("read")
        except FileError as error:
            assert str(error).startswith(str(path)), error
            lines = str(error).splitlines()
            assert all(line.startswith(str(path)) for line in lines), error
            fates.append("refused")
    fate = "refused by every command" if set(fates) == {"refused"} else "read by some"
    print("read by every command" if set(fates) == {"read"} else fate, flush=True)
"""


@pytest.fixture
def good(tmp_path):
    with create(tmp_path / "good.h5", fields=("velocity",)) as writer:
        write(writer, range(5))
        writer.finish("finished", {"evaluations": 5})
    return tmp_path / "good.h5"


def read_damaged(good, seeds):
    """Return how many files met which fate; a process that dies takes one file with it."""
    fates, todo = Counter(), list(seeds)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    path = good.with_name("damaged.h5")
    while todo:
        batch, command = todo[:BATCH], [sys.executable, "-c", READER, str(good), str(path)]
        done = subprocess.run(
            [*command, str(batch[0]), str(batch[-1] + 1)],
            capture_output=True, text=True, env=environment, check=False,
        )  # fmt: skip
        lines = done.stdout.splitlines()
        path.unlink(missing_ok=True)
        fates.update(line.split(" ", 1)[1] for line in lines if line.split(" ", 1)[1:] != [""])
        made = len(lines)
        if done.returncode:
            fates[f"died with {done.returncode}"] += 1
            print(f"seed {batch[made - 1]}: {done.returncode} {done.stderr[-600:]}")
        todo = todo[made:] if made else todo[1:]
        print(f"{len(seeds) - len(todo)} damaged files: {dict(fates)}", flush=True)
    return fates


def test_a_damaged_file_is_refused_in_one_line_or_read(good):
    fates = read_damaged(good, range(BATCH))
    assert set(fates) <= {"refused by every command", "read by some", "read by every command"}
    assert fates["refused by every command"] > BATCH // 5


@pytest.mark.long
def test_five_thousand_damaged_files(good):
    """HDF5 itself never comes back from some damage to its heap of texts: docs/reliability.md."""
    count = int(os.environ.get("RODSIM_FILES", "5000"))
    fates = read_damaged(good, range(10_000, 10_000 + count))
    hung = fates.pop(f"died with {-signal.SIGALRM}", 0)
    assert sum(fates.values()) + hung == count
    assert hung < count / 50
    assert set(fates) <= {"refused by every command", "read by some", "read by every command"}
