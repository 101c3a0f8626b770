"""No output is lost, and no two processes write the same one."""

import errno
import json
import os
import shutil
import socket
import subprocess
import sys
from contextlib import contextmanager

import pytest
from outputs import create, write

from rodsim import kernel_locks
from rodsim.errors import FileError
from rodsim.export.tables import write_csv
from rodsim.locks import NamedLock
from rodsim.output.paths import OutputLock, free_name, writing_process
from rodsim.processes import this_process


@pytest.fixture(scope="module")
def dead():
    """Number of a process that has ended."""
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    return process.pid


def lock_of(path, **owner):
    """Leave a lock that names a process, as one that was killed has left it."""
    owner = json.loads(this_process().text()) | {"started": None} | owner
    path.with_name(path.name + ".lock").write_text(json.dumps(owner))


ELSEWHERE = {"host": "elsewhere", "boot": "another machine", "pid": 4}


def test_old_outputs_get_the_next_free_name(tmp_path):
    path = tmp_path / "out.h5"
    for content, number in (("first", 1), ("second", 2)):
        path.write_text(content)
        moved = tmp_path / f"out.{number}.h5"
        assert free_name(path) == moved
        with create(path) as writer:
            assert writer.renamed_to == moved
        assert moved.read_text() == content
    assert sorted(os.listdir(tmp_path)) == ["out.1.h5", "out.2.h5", "out.h5"]


def test_overwrite_replaces(tmp_path):
    path = tmp_path / "out.h5"
    path.write_text("old")
    with create(path, overwrite=True) as writer:
        assert writer.renamed_to is None
    assert os.listdir(tmp_path) == ["out.h5"]


def test_a_second_writer_is_refused_and_harms_nothing(tmp_path):
    path = tmp_path / "out.h5"
    with create(path):
        before = path.read_bytes()
        message = f"written by process {os.getpid()} on {socket.gethostname()}"
        with pytest.raises(FileError, match=message):
            create(path, overwrite=True)
        assert path.read_bytes() == before
        assert sorted(os.listdir(tmp_path)) == ["out.h5", "out.h5.lock"]


def test_the_lock_of_a_dead_process_is_taken_over(tmp_path, dead):
    path = tmp_path / "out.h5"
    lock_of(path, pid=dead)
    (tmp_path / f".out.h5.{dead}.tmp").write_text("half built")
    create(path).finish("stopped", {})
    assert os.listdir(tmp_path) == ["out.h5"]


@pytest.mark.parametrize(
    "left",
    [
        {"pid": os.getpid()},  # the number is used again, or means nothing here
        {"pid": os.getpid(), "space": "pid:[5]"},  # of a container that has gone
        {"host": "elsewhere"},  # of a container: its own name, but the same machine
    ],
)
def test_a_lock_that_no_process_holds_is_free_whoever_it_names(tmp_path, left):
    if this_process().boot is None:
        pytest.skip("no /proc here")
    lock_of(tmp_path / "out.h5", **left)
    create(tmp_path / "out.h5").finish("stopped", {})
    assert os.listdir(tmp_path) == ["out.h5"]


@pytest.mark.parametrize("text", ["", "[]", '{"host": 4}', '{"host": "a", "pid": "b"}'])
def test_a_lock_that_a_full_disk_has_left_is_free(tmp_path, text):
    (tmp_path / "out.h5.lock").write_text(text)
    create(tmp_path / "out.h5").finish("stopped", {})
    assert os.listdir(tmp_path) == ["out.h5"]


def test_the_lock_of_another_machine_is_respected(tmp_path):
    """Over a network its lock may not be seen here."""
    lock_of(tmp_path / "out.h5", **ELSEWHERE)
    with pytest.raises(FileError, match=r"4 on elsewhere; if that .*remove .*lock"):
        create(tmp_path / "out.h5")
    assert os.listdir(tmp_path) == ["out.h5.lock"]


def test_a_full_disk_leaves_no_lock(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    lock = OutputLock(tmp_path / "out.h5")
    with monkeypatch.context() as during:
        during.setattr(os, "pwrite", full)
        with pytest.raises(FileError, match=r"out.h5: cannot be written: No space"):
            lock.acquire()
    assert os.listdir(tmp_path) == []
    lock.acquire()
    assert os.listdir(tmp_path) == ["out.h5.lock"]


def test_a_lock_is_not_written_through_a_link(tmp_path):
    (tmp_path / "precious").write_text("kept")
    (tmp_path / "out.h5.lock").symlink_to("precious")
    with pytest.raises(FileError, match="cannot be written"):
        create(tmp_path / "out.h5")
    assert (tmp_path / "precious").read_text() == "kept"


@pytest.mark.parametrize("link", ["symbolic", "of a link", "hard"])
def test_a_file_has_one_writer_under_all_its_names(tmp_path, link):
    (tmp_path / "sub").mkdir()
    path, other = tmp_path / "out.h5", tmp_path / "sub" / "link.h5"
    with create(path) as writer:
        write(writer, range(2))
        if link == "hard":
            other.hardlink_to(path)
        else:
            other.symlink_to("../out.h5")
        if link == "of a link":
            other = tmp_path / "second.h5"
            other.symlink_to("sub/link.h5")
        before = path.read_bytes()
        lock = OutputLock(other)
        with pytest.raises(FileError, match="is being written by"):
            lock.acquire()
        with pytest.raises(FileError, match="is being written by"):
            create(other, overwrite=True)
        assert path.read_bytes() == before
        assert bool(writing_process(other)) == (link != "hard")  # that has no name to tell
    lock.acquire()
    lock.release()


def test_a_link_is_written_through_and_stays(tmp_path):
    (tmp_path / "sub").mkdir()
    link, real = tmp_path / "out.h5", tmp_path / "sub" / "real.h5"
    link.symlink_to("sub/real.h5")
    for overwrite in (False, True, False):  # the first to a file that is not there yet
        with create(link, overwrite) as writer:
            assert (tmp_path / "sub" / "real.h5.lock").exists()
            write(writer, range(1))
        assert link.is_symlink()
        assert not real.is_symlink()
    assert writer.renamed_to == tmp_path / "sub" / "real.1.h5"
    assert sorted(os.listdir(tmp_path / "sub")) == ["real.1.h5", "real.h5"]


def test_readers_that_ask_hdf5_for_its_lock_are_let_in(tmp_path):
    """ParaView does: a writer that held flock on its output would keep it out."""
    read = "import h5py, sys; print(h5py.File(sys.argv[1], locking=True)['committed'][()])"
    with create(tmp_path / "out.h5") as writer:
        write(writer, range(2))
        line = [sys.executable, "-c", read, str(writer.path)]
        done = subprocess.run(line, capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("2\n", "")


HOLD = """
import sys
from rodsim.locks import NamedLock
held = NamedLock(sys.argv[1]).take()
print(held, flush=True)
sys.stdin.read()
"""


@contextmanager
def held_elsewhere(path, *before):
    """Let another process hold a lock, until it is killed."""
    line = [*before, sys.executable, "-c", HOLD, str(path)]
    with subprocess.Popen(
        line, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        said = process.stdout.readline()
        yield process, said
        process.kill()


def test_the_lock_of_a_killed_process_is_free_at_once(tmp_path):
    path = tmp_path / "out.h5"
    with held_elsewhere(f"{path}.lock") as (process, said):
        assert said == "None\n"
        assert str(writing_process(path)) == f"process {process.pid} on {socket.gethostname()}"
        with pytest.raises(FileError, match=f"by process {process.pid} on"):
            OutputLock(path).acquire()
        process.kill()
        process.wait()
        assert writing_process(path) is None
        OutputLock(path).acquire()


def test_a_process_in_another_container_is_seen(tmp_path):
    """Its number means nothing here: it can be that of anyone, or of nobody."""
    away = ("unshare", "--pid", "--fork", "--kill-child")
    if not shutil.which("unshare") or subprocess.run([*away, "true"], check=False).returncode:
        pytest.skip("needs the right to make a PID namespace")
    path = tmp_path / "out.h5"
    with held_elsewhere(f"{path}.lock", *away) as (_, said):
        assert said == "None\n"
        with pytest.raises(FileError, match=r"by process 1 on .*, in another container"):
            OutputLock(path).acquire()


@pytest.mark.parametrize(
    ("left", "free"),
    [
        ({"pid": "dead"}, True),
        ({"pid": os.getpid()}, False),
        ({"pid": os.getpid(), "started": 5}, True),  # the number is used again
        ({"pid": os.getpid(), "boot": "before"}, True),  # the machine was started again since
        ({"pid": "dead", "space": "pid:[5]"}, False),  # a container's numbers say nothing here
        (ELSEWHERE, False),
    ],
)
def test_where_the_system_has_no_locks_the_words_of_a_lock_count(
    tmp_path, monkeypatch, dead, left, free
):
    if this_process().boot is None:
        pytest.skip("no /proc here")
    for name in ("grab", "grab_beside_readers", "grabbed"):
        monkeypatch.setattr(kernel_locks, name, lambda handle: None)
    left = left | ({"pid": dead} if left["pid"] == "dead" else {})
    path = tmp_path / "out.h5"
    lock_of(path, **left)
    assert (writing_process(path) is None) == free
    if free:
        with create(path), pytest.raises(FileError, match="is being written"):
            create(path)
        assert os.listdir(tmp_path) == ["out.h5"]
    else:
        with pytest.raises(FileError, match="is being written by process"):
            create(path)


def test_a_file_that_is_replaced_is_built_where_nobody_has_put_a_link(tmp_path, monkeypatch):
    monkeypatch.setattr("os.urandom", lambda count: b"guessed!")
    guessed = b"guessed!".hex()
    (tmp_path / "precious").write_text("kept")
    (tmp_path / f".table.{guessed}.csv").symlink_to("precious")
    with pytest.raises(FileError, match=r"table.csv: cannot be written"):
        write_csv(tmp_path / "table.csv", ["a"], [])
    (tmp_path / f".out.h5.{guessed}.tmp").symlink_to("precious")
    monkeypatch.setattr("pathlib.Path.glob", lambda *_: [])  # it comes after we have looked
    with pytest.raises(FileError, match=r"out.h5: cannot be written"):
        create(tmp_path / "out.h5")
    assert (tmp_path / "precious").read_text() == "kept"


def test_a_lock_is_given_back_by_its_owner_only(tmp_path, dead):
    lock = OutputLock(tmp_path / "out.h5")
    lock.acquire()
    lock_of(tmp_path / "out.h5", pid=dead)
    lock.release()
    assert lock.path.exists()


@pytest.mark.parametrize("path", ["missing/out.h5", "folder"])
def test_places_that_cannot_hold_an_output(tmp_path, path):
    (tmp_path / "folder").mkdir()
    with pytest.raises(FileError, match=path):
        create(tmp_path / path)


def test_a_lock_in_a_folder_that_is_gone_is_an_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        NamedLock(tmp_path / "gone" / "run.lock").take()
