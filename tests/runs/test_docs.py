"""Every command and every piece of Python in the README and docs/ runs, as printed."""

import csv
import os
import re
import shlex
import subprocess
import sys
from itertools import groupby
from pathlib import Path

import numpy as np
import pytest
from scenes import ROOT

from rodsim.cli import COMMANDS, main

PAGES = sorted((ROOT / "docs").glob("*.md"))
SLOW = (
    "choosing",
    "sweeps",
    "visualization",
    "data",
    "measure",
    "wall",
    "bodies",
    "large",
    "rest",
    "figures",
)  # minutes where the machine is not quiet; and below, the tutorial
PROJECTS = ("two-flagella", "ring-buckling")  # whose numbers are looked at too
BLOCK = re.compile(r"(?:<!-- (?P<mark>[\w: ]+) -->\n)?```(?P<kind>\w+)\n(?P<text>.*?)```", re.S)
COMMAND = re.compile(r"\brodsim ([a-z][^\n|&;>]*)")
LINK = re.compile(r"\]\((?!https?:)([^)]+)\)")


def blocks(page, install=False):
    """Return (language, code) of what is to run on a page, in order."""
    found = []
    for block in BLOCK.finditer(page.read_text(encoding="utf-8")):
        if block["mark"] == "docs: elsewhere" or (block["mark"] == "docs: install" and not install):
            continue  # elsewhere: in `pytest -m paper`
        if block["kind"] in ("sh", "python"):
            found.append((block["kind"], block["text"]))
    return found


CODE = [
    pytest.param(page, marks=[pytest.mark.long] * (page.stem in SLOW))
    for page in PAGES
    if blocks(page) and page.stem not in ("tutorial", *PROJECTS)
]


def script(found):
    """Return one shell script of all blocks; Python that is not interrupted is one session."""
    lines = ["set -euo pipefail"]
    for kind, group in groupby(found, key=lambda block: block[0]):
        text = "".join(text for _, text in group)
        if kind == "python":
            lines.append(f"python - <<'END_OF_PYTHON'\n{text}END_OF_PYTHON")
        else:
            lines.append(text)
    return "\n".join(lines)


def run(text, folder):
    """Run a script as a user of this environment would, with code that is compiled already."""
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
                   "HOME": str(folder)}  # fmt: skip
    environment.pop("NUMBA_THREADING_LAYER", None)  # of this process, which has loaded tbb
    done = subprocess.run(["bash", "-c", text], cwd=folder, env=environment,
                          capture_output=True, text=True)  # fmt: skip
    assert done.returncode == 0, f"{text}\n--\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}"
    return done


@pytest.mark.compiled
@pytest.mark.parametrize("page", CODE, ids=lambda page: page.stem)
def test_a_page_of_the_docs_runs_in_an_empty_folder(page, tmp_path):
    for name in ("configs", "docs", "benchmarks"):
        (tmp_path / name).symlink_to(ROOT / name)
    run(script(blocks(page)), tmp_path)


@pytest.mark.parametrize(
    "page", [page for page in PAGES if blocks(page)], ids=lambda page: page.stem
)
def test_the_options_of_a_page_are_those_of_the_commands(page):
    """Also of pages that take too long for every day; nothing is run."""
    shell = "".join(text for kind, text in blocks(page) if kind == "sh").replace("\\\n", " ")
    for line in COMMAND.findall(shell):
        name, *words = shlex.split(line, comments=True)
        if name in COMMANDS and "$" not in line:
            main.get_command(None, name).make_context(name, words)


@pytest.mark.long
@pytest.mark.compiled
def test_two_flagella_from_nothing_to_the_numbers_of_the_page(tmp_path):
    run(script(blocks(ROOT / "docs" / "two-flagella.md")), tmp_path)
    pair, alone = (_summary(tmp_path / name / "summary.csv") for name in ("pair", "alone"))
    speeds = [*_column(pair, "left.speed"), *_column(alone, "left.speed")]
    assert speeds == pytest.approx([6.98, 11.7, 16.6, 9.82], rel=5e-3)  # as the page prints them
    powers = [*_column(pair, "left.power"), *_column(alone, "left.power")]
    assert powers == pytest.approx([2.832, 3.093, 3.409, 3.056], rel=5e-4)
    for picture in ("speed.png", "flagella.png", "shapes.png"):
        assert (tmp_path / picture).stat().st_size > 10_000


@pytest.mark.long
@pytest.mark.compiled
def test_the_ring_buckles_between_the_twists_of_the_page(tmp_path):
    run(script(blocks(ROOT / "docs" / "ring-buckling.md")), tmp_path)
    table = _summary(tmp_path / "writhe" / "summary.csv")
    writhe = dict(zip(_column(table, "strain_twist.2"), _column(table, "ring.writhe"), strict=True))
    below, above = (w for w in writhe if w < 3**0.5 / 2.5), (w for w in writhe if w > 3**0.5 / 2.5)
    assert all(abs(writhe[w]) < 1e-9 for w in below)
    assert [writhe[w] for w in above] == pytest.approx(
        [-0.822, -0.848, -0.880, -0.982, -1.155], abs=1e-3
    )
    assert abs(np.array(_column(table, "ring.link"))).max() < 1e-9
    assert not any(_column(table, "growing_modes"))


def _summary(path):
    """Return the rows of a sweep's summary."""
    with path.open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def _column(rows, name):
    """Return the numbers of a column by what its head has before the unit, or by its end."""
    head = next(h for h in rows[0] if h.partition(" (")[0].endswith(name))
    return [float(row[head]) for row in rows]


@pytest.mark.compiled
def test_the_commands_of_the_readme_run(tmp_path):
    """Its two blocks for CI are run there, from nothing; here the first one's command, and then the
    block after it, with this environment in place of a fresh one."""
    (tmp_path / ".venv").symlink_to(sys.prefix)
    (tmp_path / "configs").symlink_to(ROOT / "configs")
    marked = [(b["mark"], b["kind"], b["text"]) for b in BLOCK.finditer(_text("README.md"))]
    first = next(text for mark, _, text in marked if mark == "ci: run")
    ours = [("sh", first.split("&&")[-1])]
    ours += [("sh", text) for mark, kind, text in marked if kind == "sh" and not mark]
    ours += [("python", text) for _, kind, text in marked if kind == "python"]
    assert len(ours) >= 3
    run(script(ours), tmp_path)


@pytest.mark.long
@pytest.mark.compiled
def test_the_tutorial_from_its_install_on(tmp_path):
    """Word by word in an empty folder, with an environment and compiled code of its own."""
    (tmp_path / "rodsim").symlink_to(ROOT)
    folder = tmp_path / "first"
    folder.mkdir()
    text = script(blocks(ROOT / "docs" / "tutorial.md", install=True))
    environment = {k: v for k, v in os.environ.items() if not k.startswith("NUMBA_")}
    environment |= {"HOME": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / "cache")}
    done = subprocess.run(["bash", "-c", text], cwd=folder, env=environment,
                          capture_output=True, text=True)  # fmt: skip
    assert done.returncode == 0, done.stderr[-3000:]
    assert (folder / "energy.png").stat().st_size > 10_000
    assert (folder / "sweep/summary.csv").read_text().count("finished") == 4


def test_the_case_reference_is_that_of_the_model(tmp_path):
    made = subprocess.run(
        [sys.executable, "-c", "import case_reference; print(case_reference.page(), end='')"],
        cwd=ROOT / "docs", capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    assert made == _text("docs/case-file.md"), "run: python docs/case_reference.py"


@pytest.mark.parametrize("page", [*PAGES, ROOT / "README.md"], ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    for link in LINK.findall(page.read_text(encoding="utf-8")):
        target, _, anchor = link.partition("#")
        found = (page.parent / target) if target else page
        assert found.exists(), link
        if anchor:
            text = found.read_text(encoding="utf-8")
            headings = {_anchor(line) for line in text.splitlines()}
            assert anchor in headings | set(re.findall(r'<a id="([^"]+)">', text)), link


def test_the_list_of_pages_is_the_folder():
    """The site's navigation is made of it."""
    listed = set(re.findall(r"\]\(([\w/-]+\.md)\)", _text("docs/README.md")))
    found = {p.relative_to(ROOT / "docs").as_posix() for p in (ROOT / "docs").rglob("*.md")}
    assert listed == found - {"README.md"}


def _anchor(line):
    kept = "".join(c for c in line.lstrip("# ").lower() if c.isalnum() or c in " -_")
    return kept.replace(" ", "-") if line.startswith("#") else ""


def _text(name):
    return (ROOT / name).read_text(encoding="utf-8")
