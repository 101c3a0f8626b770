"""A case that begins in the state in an output."""

from __future__ import annotations

import json
from pathlib import Path


def start_in(source, frame: int) -> str:
    """Return the override that makes a case begin in a frame of an output."""
    return f"initial={json.dumps({'path': str(Path(source).absolute()), 'frame': frame})}"
