"""Cases that come with rodsim: commented ones, which lie here, and the scenes of ``configs/``."""

from __future__ import annotations

from pathlib import Path

from rodsim.case.words import did_you_mean
from rodsim.case.yaml_text import parse
from rodsim.errors import UsageError
from rodsim.files import shipped
from rodsim.text import texts_in

TEMPLATES = ("open", "ring", "flagellum")  # the paper's three scenes, shortened
EDITOR_LINE = "# yaml-language-server:"  # names a schema that lies beside the configs alone


def scenes() -> dict[str, Path]:
    """Return the files of all that is shipped by name: templates, cases, tables for sweeps."""
    found = {name: Path(__file__).with_name(f"{name}.yaml") for name in TEMPLATES}
    for kind in ("yaml", "csv"):
        for path in sorted(shipped("configs").glob(f"*.{kind}")):
            found.setdefault(path.stem, path)  # a table beside the case of its name is part of it
    return found


def template(name: str) -> str:
    """Return the text of a shipped case, such as ``ring`` or ``bacterium``; raises UsageError."""
    text = _path(name).read_text(encoding="utf-8")
    return text.partition("\n")[2] if text.startswith(EDITOR_LINE) else text


def title(name: str) -> str:
    """Return in a line what a shipped case is."""
    path = _path(name)
    if path.suffix == ".csv":
        return template(name).partition("\n")[0].lstrip("# ")
    return parse(template(name), str)[0]["title"]


def tables_of(name: str) -> list[Path]:
    """Return the files that a shipped case reads; they lie beside it."""
    path = _path(name)
    if path.suffix == ".csv":
        return []
    beside = {p.name: p for p in path.parent.iterdir() if p.suffix != ".py"}
    texts = dict.fromkeys(texts_in(parse(template(name), str)[0]))
    return [beside[text] for text in texts if text in beside]


def _path(name: str) -> Path:
    known = scenes()
    if name not in known:
        hint = did_you_mean(name, known) or ": rodsim new lists them"
        raise UsageError(f"no case called '{name}'{hint}")
    return known[name]
