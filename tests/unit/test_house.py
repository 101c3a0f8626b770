"""The rooms of the house: data flows down, and CONTRIBUTING's list is the tree."""

import ast
import re
from functools import lru_cache
from pathlib import Path

import rodsim

HOUSE = Path(rodsim.__file__).parent
LIST = (HOUSE.parent / "CONTRIBUTING.md").read_text(encoding="utf-8")
ROW = re.compile(r"^\| ((?:`[\w./]+`(?:, )?)+) \|", re.M)


@lru_cache
def floors():
    """Rooms and loose files of each row of CONTRIBUTING's list, from the top down."""
    rows = [re.findall(r"`([\w.]+?)(?:\.py|/)`", row) for row in ROW.findall(LIST)]
    assert len(rows) > 7
    return rows


def floor_of(name):
    """Return the number of the row that a room or loose file stands in."""
    return next(i for i, row in enumerate(floors()) if name in row)


def imports(path):
    """Yield (line, module) of everything of rodsim that a file imports, anywhere in it."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("rodsim"):
            yield node.lineno, node.module
        elif isinstance(node, ast.Import):
            yield from ((node.lineno, a.name) for a in node.names if a.name.startswith("rodsim"))


def files():
    return sorted(p for p in HOUSE.rglob("*.py") if p != HOUSE / "__init__.py")


def test_no_import_runs_upward():
    upward = []
    for path in files():
        room = path.relative_to(HOUSE).parts[0].removesuffix(".py")
        for line, module in imports(path):
            below = module.split(".")[1:2]  # none for rodsim itself: its version
            if below and floor_of(below[0]) < floor_of(room):
                upward.append(f"{path.relative_to(HOUSE)}:{line} imports {module}")
    assert upward == []


def test_the_list_of_contributing_is_the_tree():
    listed = {name for row in floors() for name in row}
    rooms = {p.name for p in HOUSE.iterdir() if p.is_dir() and p.name != "__pycache__"}
    loose = {p.stem for p in HOUSE.glob("*.py")} - {"__init__"}
    assert listed == rooms | loose


def test_scipy_is_for_states_at_rest_and_imported_where_it_is_used():
    """So whoever runs a scene does not wait for it, nor needs it."""
    for path in files():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        found = [n for n in ast.walk(tree) if isinstance(n, ast.ImportFrom | ast.Import)]
        names = [
            n.module or "" if isinstance(n, ast.ImportFrom) else n.names[0].name for n in found
        ]
        if any(name.startswith("scipy") for name in names):
            assert path.relative_to(HOUSE).parts[0] == "rest", path
        top = [n for n in tree.body if n in found]
        assert not [n for n in top if (getattr(n, "module", "") or "").startswith("scipy")], path


def test_nobody_asks_for_a_method_by_name():
    """What is known of a method stands in case/methods.py; others read it there."""
    for path in files():
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"[!=]= \"(rkc|rk4|euler)\"", text), path
