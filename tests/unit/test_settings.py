import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest

from rodsim.compiled.folder import private_folder

CODE = """
from rodsim.compiled.settings import prepare
prepare()
import os
print(os.environ["NUMBA_CACHE_DIR"])
"""


def cache_of(home):
    environment = {**os.environ, "XDG_CACHE_HOME": str(home)}
    environment.pop("NUMBA_CACHE_DIR", None)
    done = subprocess.run(
        [sys.executable, "-c", CODE], env=environment, capture_output=True, text=True, check=True
    )
    return Path(done.stdout.strip())


def test_compiled_code_is_kept_in_the_users_own_folder(tmp_path):
    first, again = cache_of(tmp_path), cache_of(tmp_path)
    assert first == again
    assert first.parent == tmp_path / "rodsim"
    assert first.is_dir()


def test_where_that_cannot_be_written_the_process_has_a_folder_of_its_own(tmp_path):
    (tmp_path / "file").write_text("in the way")
    folder = cache_of(tmp_path / "file")
    assert tmp_path not in folder.parents
    assert not folder.exists()  # gone with the process


def test_a_folder_that_others_may_write_is_not_used(tmp_path):
    folder = cache_of(tmp_path)
    folder.chmod(0o777)
    assert tmp_path not in cache_of(tmp_path).parents
    folder.chmod(0o700)
    assert cache_of(tmp_path) == folder


def test_a_folder_of_code_is_made_for_its_owner_alone(tmp_path):
    folder = private_folder(tmp_path / "made" / "rodsim" / "code")
    for part in (folder, folder.parent):
        assert part.stat().st_mode & 0o777 == 0o700
    folder.parent.chmod(0o775)
    private_folder(folder)
    assert folder.parent.stat().st_mode & 0o777 == 0o755
    folder.chmod(0o720)
    with pytest.raises(PermissionError, match="others may write it, so it is not used"):
        private_folder(folder)


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="no owners here")
def test_a_folder_of_someone_else_is_not_used(tmp_path, monkeypatch):
    folder = private_folder(tmp_path / "rodsim" / "code")
    monkeypatch.setattr(os, "geteuid", lambda: folder.stat().st_uid + 1)
    with pytest.raises(PermissionError, match="belongs to another user"):
        private_folder(folder)


def test_importing_the_library_changes_no_setting():
    code = "import os; before = dict(os.environ); import rodsim.run.simulate, rodsim.run.machine; "
    code += "assert dict(os.environ) == before"
    kept = "NUMBA_CACHE_DIR"  # what was compiled for the command is read from there
    environment = {k: v for k, v in os.environ.items() if k == kept or not k.startswith("NUMBA_")}
    done = subprocess.run([sys.executable, "-c", code], env=environment, check=False)
    assert done.returncode == 0


@pytest.mark.parametrize("name", ["NUMBA_CACHE_DIR", "OMP_WAIT_POLICY"])
def test_what_the_user_has_set_is_left_alone(name, tmp_path):
    code = "from rodsim.compiled.settings import prepare; prepare(); import os; "
    code += f"print(os.environ[{name!r}])"
    environment = {**os.environ, name: str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == str(tmp_path)


NAMES = "sse2 sse3 ssse3 sse4.1 sse4.2 avx avx2 fma avx512f avx512dq avx512vl avx512bw popcnt"
WIDE = """
import re, sys
import llvmlite.binding as llvm
class Server(dict):  # what LLVM finds on an Intel server
    flatten = lambda self: ",".join(f"+{name}" for name in self)
names = "NAMES"
llvm.get_host_cpu_features = lambda: Server.fromkeys(names.split(), True)
llvm.get_host_cpu_name = lambda: "icelake-server"
if sys.argv[1] == "command":
    from rodsim.compiled.settings import prepare
    prepare()
from rodsim.flows.free import planar_7
code = planar_7._compiled._library.get_asm_str()  # compiled, never run
found = {}
for name, pattern in (("wide", "fmadd.*%zmm"), ("root", "sqrtpd"), ("estimate", "rsqrtps.*%ymm")):
    found[name] = len(re.findall(pattern, code)) > 0
print(found)
""".replace("NAMES", NAMES)


@pytest.mark.compiled
@pytest.mark.skipif(platform.machine() != "x86_64", reason="vectors of x86")
@pytest.mark.parametrize("who", ["command", "library"])
def test_sums_have_vectors_of_512_bits_and_estimates_of_roots(tmp_path, who):
    found = compiled_on_a_server(tmp_path, who)
    assert found == "{'wide': True, 'root': False, 'estimate': True}"


@pytest.mark.compiled
@pytest.mark.skipif(platform.machine() != "x86_64", reason="vectors of x86")
def test_vectors_of_256_bits_stay_where_the_user_asks_for_them(tmp_path):
    features = ",".join(f"+{name}" for name in (*NAMES.split(), "prefer-256-bit"))
    found = compiled_on_a_server(tmp_path, "command", NUMBA_CPU_FEATURES=features)
    assert found == "{'wide': False, 'root': True, 'estimate': False}"


def compiled_on_a_server(folder, who, **asked):
    """Return what the code of a sum has that is compiled for an Intel server."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("NUMBA_CPU_")}
    done = subprocess.run(
        [sys.executable, "-c", WIDE, who],
        env={**environment, "NUMBA_CACHE_DIR": str(folder), **asked},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    return done.stdout.strip()
