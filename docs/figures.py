"""Make the figures of figures.md: run its commands, as printed, and keep the pictures.

    python docs/figures.py [WORD...]    # only figures whose commands have one of the words

Runs go to a temporary folder, or to that in RODSIM_FIGURES, where they are found again.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

DOCS = Path(__file__).parent
BLOCK = re.compile(r"```sh\n(.*?)```", re.S)
LARGEST = 150_000  # bytes of a picture


def commands() -> list[str]:
    """Return the blocks of commands of the page, in order."""
    text = (DOCS / "figures.md").read_text(encoding="utf-8")
    return [block for block in BLOCK.findall(text) if block.startswith("rodsim")]


def make(folder: Path, words: list[str]) -> None:
    """Run the commands in a folder; keep each picture that is linked on the page."""
    (folder / "configs").unlink(missing_ok=True)
    (folder / "configs").symlink_to(DOCS.parent.resolve() / "configs")
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    for block in commands():
        if not words or any(word in block for word in words):
            print(block, flush=True)
            subprocess.run(
                ["bash", "-ec", block], cwd=folder, env={**os.environ, "PATH": path}, check=True
            )
    for picture in sorted(folder.glob("column_*.png")):
        if picture.stat().st_size > LARGEST:
            raise SystemExit(f"{picture.name}: {picture.stat().st_size} bytes, over {LARGEST}")
        shutil.copy(picture, DOCS / "images" / picture.name)


if __name__ == "__main__":
    if place := os.environ.get("RODSIM_FIGURES"):
        make(Path(place), sys.argv[1:])
    else:
        with tempfile.TemporaryDirectory() as temporary:
            make(Path(temporary), sys.argv[1:])
