"""Checks an installed wheel: what it is said to be, and that all scenes are in it."""

import re
import tomllib
from importlib.metadata import metadata
from pathlib import Path

import rodsim
from rodsim.case.templates import TEMPLATES, scenes, tables_of, template, title

source = Path(__file__).parent.parent
package = Path(rodsim.__file__).parent
assert source not in package.parents, f"{package} is not that of the wheel"
assert (package / "py.typed").exists()

shipped = {path.stem for path in (source / "configs").iterdir()} - {"rodsim.schema"}
assert scenes().keys() == shipped | {*TEMPLATES}, scenes().keys() ^ shipped
for name in scenes():
    assert title(name), name
    assert template(name), name
assert [path.name for path in tables_of("traced_filament")] == ["traced_filament.csv"]

said = metadata("rodsim")
asked = tomllib.loads((source / "pyproject.toml").read_text(encoding="utf-8"))["project"]
assert said["License-Expression"] == "MIT"
assert said["Version"] == rodsim.__version__
assert {*said.get_all("Provides-Extra")} == {*asked["optional-dependencies"]}
links = re.findall(r"\]\(([^)]+)\)", said.get_payload())
lost = [link for link in links if not link.startswith(("https://", "#"))]
assert said.get_payload().count("\n## ") > 3
assert not lost, f"the README leads nowhere from elsewhere: {lost}"
what = f"{len(scenes())} scenes, {len(links)} links"
print(f"rodsim {said['Version']} in {package.parent.name}: {what}")
