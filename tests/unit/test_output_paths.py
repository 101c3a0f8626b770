"""No output is lost, and no two processes write the same one."""

import json
import os
import socket
import subprocess
import sys

import pytest
from outputs import create

from rodsim.errors import FileError
from rodsim.output.paths import OutputLock, free_name


@pytest.fixture(scope="module")
def dead():
    """Number of a process that has ended."""
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    return process.pid


def lock_of(path, **owner):
    owner = {"host": socket.gethostname(), "pid": os.getpid(), "started": None} | owner
    path.with_name(path.name + ".lock").write_text(json.dumps(owner))


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


def test_a_process_number_that_is_used_again_is_recognised(tmp_path):
    if json.loads(OutputLock(tmp_path / "x")._text)["started"] is None:
        pytest.skip("no /proc here")
    lock_of(tmp_path / "out.h5", started=5)
    create(tmp_path / "out.h5").finish("stopped", {})
    assert os.listdir(tmp_path) == ["out.h5"]


@pytest.mark.parametrize("owner", [{"host": "elsewhere", "pid": 4}, {"pid": os.getpid()}])
def test_locks_that_may_be_alive_are_respected(tmp_path, owner):
    lock_of(tmp_path / "out.h5", **owner)
    with pytest.raises(FileError, match=f"process {owner['pid']} on .*remove .*out.h5.lock"):
        create(tmp_path / "out.h5")
    assert os.listdir(tmp_path) == ["out.h5.lock"]


@pytest.mark.parametrize("text", ["", "[]", '{"host": 4}', '{"host": "a", "pid": "b"}'])
def test_a_lock_that_cannot_be_read_is_respected(tmp_path, text):
    (tmp_path / "out.h5.lock").write_text(text)
    with pytest.raises(FileError, match="lock cannot be read"):
        create(tmp_path / "out.h5")


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
