"""Text from files: made fit for a terminal, found in plain data."""

from collections.abc import Iterator


def printable(text: str) -> str:
    """Return text with all but line ends and printable characters escaped.

    Escape sequences in a file can clear a terminal, rename its window, or hide what follows.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c == "\n" else _escaped(c) for c in text)


def _escaped(character: str) -> str:
    return character.encode("unicode_escape").decode()


def texts_in(node) -> Iterator[str]:
    """Yield all texts in nested plain data but the keys."""
    if isinstance(node, str):
        yield node
    elif isinstance(node, dict | list):
        for item in node.values() if isinstance(node, dict) else node:
            yield from texts_in(item)
