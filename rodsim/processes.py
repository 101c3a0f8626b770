"""Starting this very rodsim in another process."""

import sys
from pathlib import Path

import rodsim


def this_rodsim(module: str = "rodsim") -> list[str]:
    """Return the command that runs a module of the rodsim that is running now.

    ``python -m`` looks into the current folder first, where another copy can lie: the source that
    this one was installed from.
    """
    root = str(Path(rodsim.__file__).parent.parent)
    safe = ["-P"] if root in sys.path[1:] else []  # sys.path[0] is the folder that -P leaves out
    return [sys.executable, *safe, "-m", module]
