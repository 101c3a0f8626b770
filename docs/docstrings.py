"""Docstrings for the docs site: their sections as lists, what they refer to as code."""

from __future__ import annotations

import re

import griffe

SECTION = re.compile(r"^(\w+)\n-+\n((?:.+\n?)+)", re.M)
ITEM = re.compile(r"(?:^|(?<=[.;]) )(\w+(?:, \w+)*) : ", re.M)  # also several in a line
SESSION = re.compile(r"(?:^(?:>>>|\.\.\.) .+\n?)+", re.M)  # of the interpreter
ROLE = re.compile(r":\w+:`~?(?:\w+\.)*(\w+)`")


class Lists(griffe.Extension):
    """Makes Markdown of what numpydoc would take for types: here it is meaning, shape and unit."""

    def on_object(self, *, obj, **_):
        """Rewrite the docstring of whatever has one."""
        if obj.docstring:
            text = ROLE.sub(r"`\1`", obj.docstring.value)
            text = SESSION.sub(lambda code: f"```pycon\n{code[0].rstrip()}\n```\n", text)
            obj.docstring.value = SECTION.sub(_listed, text)


def _listed(section):
    title, body = section.groups()
    body = re.sub(r"\n +", " ", body.strip())  # lines that go on with the one before
    items = ITEM.sub(r"\n* `\1`: ", body).strip()
    return f"**{title}**\n\n{items}\n"
