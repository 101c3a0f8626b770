"""The kinds of parts, in the order in which they act: one line each.

A kind is a file in ``forces/`` or ``flows/`` with its words in the case file, its numbers, its
kernel, its energy or work. ``RODSIM_PARTS``, names of modules with commas between them, adds kinds
of your own.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from typing import Any

KINDS = (
    "rodsim.forces.elastic",
    "rodsim.flows.fluid",
)


@dataclass(frozen=True)
class Kind:
    """A kind of part.

    build : called with (case, rods, :class:`rodsim.scene.state.Frame`), returns its parts in that
    scene, none where the case does not ask for it. word : its key in the case file, in the section
    ``where`` (``case``, ``fluid`` or ``rod``). words : the type of what stands there, ``default``
    what is meant where nothing does, ``about`` its line in the schema. check : called with a case,
    yields (path, reason) of what is wrong across sections.
    """

    build: Callable
    word: str = ""
    where: str = ""
    words: Any = None
    default: Any = None
    about: str = ""
    check: Callable | None = None


@lru_cache(maxsize=1)
def kinds() -> tuple[Kind, ...]:
    """Return all kinds, the user's own last."""
    own = [name.strip() for name in os.environ.get("RODSIM_PARTS", "").split(",")]
    return tuple(import_module(name).KIND for name in (*KINDS, *filter(None, own)))
