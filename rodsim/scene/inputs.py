"""What the files that a case names contained, as digests: has a result been made from the same?"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

from rodsim.case.inputs import input_entries
from rodsim.errors import FileError
from rodsim.files import has_hdf5_signature

SAME, CHANGED, GONE = "unchanged", "has changed since", "cannot be read any more"


def digests(data: dict, folder, known: dict | None = None) -> dict[str, dict[str, str]]:
    """Return ``{key: {"file": path, "sha256": digest}}`` of the files that a case names.

    data : the resolved case. folder : what relative names are relative to. known : digests of
    earlier calls, by file and frame, for callers with many cases; added to.

    Of a table it is the SHA-256 of the file; of an output that of the frame, the positions and
    triads in it and the rods they belong to, so that a run repeated to the same bits is the same.
    A file that cannot be read has the digest "".
    """
    found, known = {}, {} if known is None else known
    for key, entry, name in input_entries(data):
        path = (Path(folder) / entry[name]).absolute()
        which = str(path), entry.get("frame")
        if which not in known:
            known[which] = _digest(path, entry.get("frame"))
        found[key] = {"file": str(path), "sha256": known[which]}
    return found


def case_digests(case) -> dict[str, dict[str, str]]:
    """Return the digests of a case as loaded; empty where it names no file."""
    folder = case.folder
    return digests(case.resolved(), folder)


def compare_inputs(stored: dict, now: dict) -> dict[str, tuple[str, str]]:
    """Return ``{key: (file, state)}``, state SAME, CHANGED or GONE, of what a result came from.

    ``stored`` : the digests that were taken then. What they do not have counts as changed.
    """
    return {key: (entry["file"], _state(stored.get(key), entry)) for key, entry in now.items()}


def look_again(stored: dict, data: dict) -> dict[str, tuple[str, str]]:
    """Return what ``compare_inputs`` does, for the files that a stored run has named."""
    now = {}
    for key, entry, _ in input_entries(data):
        if key in stored:
            file = stored[key]["file"]
            now[key] = {"file": file, "sha256": _digest(Path(file), entry.get("frame"))}
    return compare_inputs(stored, now)


def stored_digests(text: str) -> dict[str, dict[str, str]]:
    """Return the digests in an output's text; none of it is trusted to be what it should."""
    try:
        found = json.loads(text or "{}")
        return {k: {n: str(v[n]) for n in ("file", "sha256")} for k, v in found.items()}
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return {}


def _state(then, now):
    if then is None or then["sha256"] != now["sha256"] != "":
        return CHANGED
    return SAME if now["sha256"] else GONE


def _digest(path, frame):
    try:
        if has_hdf5_signature(path):
            return _frame_digest(path, -1 if frame is None else frame)
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except (OSError, FileError, IndexError, ValueError):
        return ""


def _frame_digest(path, frame):
    from rodsim.output import open_trajectory

    with open_trajectory(path) as run:
        digest = hashlib.sha256(repr((run.rods, sorted(run.units.items()))).encode())
        for name in ("position", "director"):
            digest.update(run.read(name, frame).tobytes())
    return digest.hexdigest()
