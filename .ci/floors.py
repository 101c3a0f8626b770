"""Prints the oldest versions that pyproject.toml allows, as constraints for pip."""

import re
import tomllib
from itertools import chain
from pathlib import Path

project = tomllib.loads((Path(__file__).parent.parent / "pyproject.toml").read_text())["project"]
wanted = chain(project["dependencies"], *project["optional-dependencies"].values())
for text in dict.fromkeys(wanted):
    if found := re.match(r"([A-Za-z0-9_-]+)>=([0-9.]+)", text):
        print(f"{found[1]}=={found[2]}")
