"""The example notebooks: without outputs, and they run as they are."""

import json
import os
from pathlib import Path

import pytest
from scenes import ROOT

NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))


def test_there_are_two():
    assert len(NOTEBOOKS) >= 2


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_small_and_has_no_outputs(path):
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert code
    assert not any(cell["outputs"] or cell["execution_count"] for cell in code)
    assert path.stat().st_size < 20_000


@pytest.mark.long
@pytest.mark.compiled
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_in_an_empty_folder(path, tmp_path):
    nbformat = pytest.importorskip("nbformat", reason="pip install 'rodsim[notebook]'")
    nbclient = pytest.importorskip("nbclient", reason="pip install 'rodsim[notebook]'")
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    kernel = {**os.environ, "MPLBACKEND": "module://matplotlib_inline.backend_inline"}
    client = nbclient.NotebookClient(
        notebook, timeout=None, resources={"metadata": {"path": str(tmp_path)}}
    )
    client.execute(env=kernel)
    shown = [out for cell in notebook.cells for out in cell.get("outputs", ())]
    pictures = [out for out in shown if "image/png" in out.get("data", {})]
    assert len(pictures) >= 2
    assert not any(out["output_type"] == "error" for out in shown)
    assert {Path(name).suffix for name in os.listdir(tmp_path)} == {".h5"}
