"""The README for package indexes: its links lead to the repository, or are plain words.

A build hook of hatchling. Where ``[project.urls]`` of pyproject.toml names no ``Source``, nothing
outside of the README can be linked to: links keep their words, pictures are left out.
"""

from __future__ import annotations

import re
from pathlib import Path

from hatchling.metadata.plugin.interface import MetadataHookInterface

PICTURE = re.compile(r"!\[([^\]]*)\]\((?!https?:)([^)]+)\)")
LINK = re.compile(r"(?<!!)\[([^\]]+)\]\((?!https?:|#)([^)]+)\)")
PICTURES = re.compile(
    r"(?:^\|.*\n)*^\|.*!\[.*\n(?:^\|.*\n)*|^!\[.*\n", re.M
)  # a table of them, or one
COMMENT = re.compile(r"^<!--.*-->\n", re.M)


def elsewhere(text: str, source: str | None) -> str:
    """Return the README with links that hold away from the repository at the URL ``source``."""
    text = COMMENT.sub("", text)
    if source is None:
        return LINK.sub(r"\1", PICTURES.sub("", text))
    root = source.rstrip("/")
    text = PICTURE.sub(rf"![\1]({root}/raw/HEAD/\2)", text)
    return LINK.sub(rf"[\1]({root}/blob/HEAD/\2)", text)


class Readme(MetadataHookInterface):
    """Gives the package its README."""

    def update(self, metadata):
        """Set ``readme`` of the metadata."""
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        text = elsewhere(text, metadata.get("urls", {}).get("Source"))
        metadata["readme"] = {"content-type": "text/markdown", "text": text}
