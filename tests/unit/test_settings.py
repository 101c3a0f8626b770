import os
import subprocess
import sys
from pathlib import Path

import pytest

CODE = """
from rodsim.settings import prepare
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
    assert folder.is_dir()
    assert tmp_path not in folder.parents
    folder.rmdir()


def test_importing_the_library_changes_no_setting():
    code = "import os; before = dict(os.environ); import rodsim.simulation, rodsim.machine; "
    code += "assert dict(os.environ) == before"
    environment = {k: v for k, v in os.environ.items() if not k.startswith("NUMBA_")}
    done = subprocess.run([sys.executable, "-c", code], env=environment, check=False)
    assert done.returncode == 0


@pytest.mark.parametrize("name", ["NUMBA_CACHE_DIR", "OMP_WAIT_POLICY"])
def test_what_the_user_has_set_is_left_alone(name, tmp_path):
    code = f"from rodsim.settings import prepare; prepare(); import os; print(os.environ[{name!r}])"
    environment = {**os.environ, name: str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == str(tmp_path)
