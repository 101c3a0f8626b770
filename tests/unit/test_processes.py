"""A process that rodsim starts is of the same rodsim, whatever lies in the current folder."""

import subprocess
import sys
from pathlib import Path

import rodsim
from rodsim.processes import this_rodsim

ROOT = Path(rodsim.__file__).parent.parent
TELL = "import sys; sys.path.insert(0, ''); import rodsim.processes as p; print(p.this_rodsim())"


def test_another_copy_in_the_current_folder_is_not_taken(tmp_path):
    (tmp_path / "rodsim").mkdir()
    (tmp_path / "rodsim" / "__init__.py").write_text("raise SystemExit('the wrong one')")
    done = subprocess.run(
        [*this_rodsim(), "--version"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.split()[-1] == rodsim.__version__


def test_a_copy_found_in_the_current_folder_alone_is_found_again(tmp_path):
    (tmp_path / "rodsim").symlink_to(ROOT / "rodsim")
    done = subprocess.run(
        [sys.executable, "-c", TELL], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout == f"{[sys.executable, '-m', 'rodsim']}\n"
