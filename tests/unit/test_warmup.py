"""What counts as compiled: a list with checksums, against every way a cache can be broken."""

import os
import subprocess
import sys

import pytest
from scenes import load

from rodsim.compiled import settings
from rodsim.compiled.folder import alone
from rodsim.run import warmup
from rodsim.run.warmup import LIST, is_compiled, note_compiled
from rodsim.scene.build import build_scene

CAPTURED = {"capture_output": True, "text": True, "check": False}
RING, PLANE = "here-algebraic7-0-0", "here-algebraic7-1-0"


@pytest.fixture
def folder(tmp_path):
    """A cache of one kernel: an index, which is a pickle, and compiled code."""
    return fill(tmp_path / "here")


def fill(folder):
    (folder / "sums").mkdir(parents=True)
    (folder / "sums" / "sum.nbi").write_bytes(b"\x80\x04index.")
    (folder / "sums" / "sum.1.nbc").write_bytes(b"\x80\x04machine code.")
    note_compiled(folder, RING)
    return folder


def test_only_what_is_listed_is_compiled(folder):
    assert is_compiled(folder, RING)
    assert not is_compiled(folder, PLANE)
    note_compiled(folder, PLANE)
    assert is_compiled(folder, RING)
    assert is_compiled(folder, PLANE)


def test_what_other_kinds_of_the_same_installation_needed_is_compiled(folder):
    note_compiled(folder, "here-wall-tethers")
    assert is_compiled(folder, "here-algebraic7-tethers")
    assert not is_compiled(folder, "here-algebraic7-tethers-contact")
    note_compiled(folder, "there-contact")
    assert not is_compiled(folder, "here-contact")
    assert not is_compiled(folder, "elsewhere-wall")


def test_a_kernel_that_came_later_changes_nothing(folder):
    (folder / "sums" / "sum.nbi").write_bytes(b"\x80\x04longer index.")
    (folder / "sums" / "sum.2.nbc").write_bytes(b"\x80\x04other code.")
    assert is_compiled(folder, RING)


@pytest.mark.parametrize(
    ("name", "contents"),
    [
        ("sums/sum.1.nbc", b"\x80\x04mach"),
        ("sums/sum.1.nbc", b"\x80\x04machine c0de."),
        ("sums/sum.1.nbc", None),
        ("sums/sum.nbi", b"\x80\x04ind"),
        ("sums/sum.nbi", b""),
        ("sums/sum.nbi", bytes(8)),
        (LIST, b"{"),
        (LIST, b"[]"),
        (LIST, None),
    ],
)
def test_a_broken_cache_is_not_compiled(folder, name, contents):
    (folder / name).unlink()
    if contents is not None:
        (folder / name).write_bytes(contents)
    assert not is_compiled(folder, RING)


def test_in_a_folder_of_the_user_the_files_of_others_do_not_count(tmp_path):
    folder = fill(tmp_path / "mine")
    (folder / "sums" / "sum.nbi").write_bytes(b"what another program keeps there")
    assert is_compiled(folder, RING)


def test_links_that_wait_under_the_names_of_the_cache_are_not_followed(folder, tmp_path):
    victim = tmp_path / "victim"
    victim.write_text("precious")
    (folder / "lock").symlink_to(victim)
    (folder / f"{LIST}.{os.getpid()}").symlink_to(victim)
    with pytest.raises(OSError, match="symbolic link"), alone(folder / warmup.LOCK):
        raise AssertionError("the lock was taken")
    note_compiled(folder, PLANE)
    assert victim.read_text() == "precious"
    assert is_compiled(folder, PLANE)


FIRST = """
import importlib, os, pkgutil, sys
import h5py, numba, numpy, pydantic
import rodsim
for room in "compiled", "forces", "flows", "blocks", "integrators", "scene", "run":
    package = importlib.import_module(f"rodsim.{room}")
    names = [each.name for each in pkgutil.iter_modules(package.__path__, f"rodsim.{room}.")]
    for name in names:
        child = os.fork()
        if not child:
            for loaded in [each for each in sys.modules if each.startswith("rodsim")]:
                del sys.modules[loaded]
            importlib.import_module(name)
            os._exit(0)
        assert os.waitpid(child, 0)[1] == 0, name
    print(len(names))
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_what_is_compiled_can_be_imported_before_anything_else():
    """As in the process that compiles: a circle of imports there was seen by nobody."""
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run([sys.executable, "-c", FIRST], env=environment, **CAPTURED)
    assert done.returncode == 0, done.stderr
    assert all(int(number) >= 5 for number in done.stdout.split())


def test_a_process_that_cannot_compile_says_why(tmp_path, monkeypatch):
    said = []
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.delenv("NUMBA_DISABLE_JIT", raising=False)
    monkeypatch.setattr(warmup, "jit_is_off", lambda: False)
    code = "import sys; sys.exit('no compiler')"
    monkeypatch.setattr(warmup, "this_rodsim", lambda _: [sys.executable, "-c", code])
    warmup.ensure_compiled(build_scene(load("closed_ring")), said.append)
    assert said[1].endswith("the run itself compiles, now and every time: no compiler")
    assert not (tmp_path / LIST).exists()


def test_once_is_not_said_where_nothing_can_be_kept(monkeypatch):
    said = []
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.delenv("NUMBA_DISABLE_JIT", raising=False)
    monkeypatch.setattr(settings, "_not_kept", ["/home/me/.cache: Read-only file system"])
    scene = build_scene(load("closed_ring"))
    assert warmup.ensure_compiled(scene, said.append) == 0.0
    assert said == [
        "compiling for this kind of scene, as at every run, for nothing can be kept "
        "(/home/me/.cache: Read-only file system); some seconds"
    ]


def test_another_processor_source_or_version_has_a_cache_of_its_own(tmp_path, monkeypatch):
    monkeypatch.setattr(settings, "fingerprint", settings.fingerprint.__wrapped__)  # not kept
    source = tmp_path / "rodsim" / "__init__.py"
    source.parent.mkdir()
    source.write_text("here")
    monkeypatch.setattr(settings.rodsim, "__file__", str(source))
    folders = [settings.cache_folder()]
    source.write_text("there")
    folders.append(settings.cache_folder())
    monkeypatch.setattr(settings, "_processor", lambda: "another")
    folders.append(settings.cache_folder())
    monkeypatch.setattr(settings, "version", lambda name: "99")
    folders.append(settings.cache_folder())
    monkeypatch.setattr(settings.rodsim, "__version__", "99")
    folders.append(settings.cache_folder())
    assert len(set(folders)) == 5
