"""The kinds of parts, in the order in which they act: one line each.

A kind is a file in ``forces/``, ``flows/`` or ``blocks/`` with its words in the case file, its
numbers, its kernel, its energy or work. ``RODSIM_PARTS``, names of modules with commas between
them, adds kinds of your own.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib import import_module
from typing import Annotated, Any

KINDS = (
    "rodsim.forces.elastic",
    "rodsim.forces.loads",
    "rodsim.forces.tethers",
    "rodsim.forces.contact",
    "rodsim.blocks.build",
    "rodsim.blocks.build:START",
    "rodsim.blocks.build:END",
    "rodsim.flows.fluid",
    "rodsim.flows.fast.kind",
    "rodsim.flows.background",
)


@dataclass(frozen=True)
class Kind:
    """A kind of part.

    build : called with (case, scene), returns its parts in that scene, none where the case does not
    ask for it. Raises CaseError.
    word : its key in the case file, in the section ``where`` (Case, Fluid or Rod). words : the type
    of what stands there. dimension, about : of the schema.
    check : called with a case, sections of which may be None, and the names of all rods of the
    file, also of those that did not validate; yields (path, reason) of what is wrong across
    sections. doubt : called with the same case, yields the same of what does not stop a run.
    """

    build: Callable
    word: str = ""
    where: str = ""
    words: Any = None
    dimension: str = ""
    about: str = ""
    check: Callable | None = None
    doubt: Callable | None = None


@lru_cache(maxsize=1)
def kinds() -> tuple[Kind, ...]:
    """Return all kinds, the user's own last."""
    own = [name.strip() for name in os.environ.get("RODSIM_PARTS", "").split(",")]
    return (*map(_kind, KINDS), *map(_own, filter(None, own)))


def _kind(name: str) -> Kind:
    """Return the KIND of a module, or another one that it has, as ``module:NAME``."""
    module, _, which = name.partition(":")
    return getattr(import_module(module), which or "KIND")


def _own(name: str) -> Kind:
    """Return a kind that is not one of rodsim's; raises UsageError."""
    from rodsim.errors import UsageError

    try:
        return import_module(name).KIND
    except ImportError as error:
        raise UsageError(f"RODSIM_PARTS: cannot import '{name}': {error}") from error
    except AttributeError:
        raise UsageError(f"RODSIM_PARTS: '{name}' has no KIND: see docs/own-parts.md") from None


def with_words(model: type) -> type:
    """Return a model of the case file with the words of all kinds that belong there.

    A word that is left out is None, and leaves the resolved case as it would be without the kind.
    """
    from pydantic import Field, create_model

    fields = {
        kind.word: (
            Annotated[kind.words | None, _Late(kind.words | None)],
            Field(
                None,
                description=kind.about,
                json_schema_extra={"dimension": kind.dimension} if kind.dimension else None,
            ),
        )
        for kind in kinds()
        if kind.where == model.__name__
    }
    names = {"__module__": model.__module__, "__doc__": model.__doc__}
    return create_model(model.__name__, __base__=model, **names, **fields)


class _Late:
    """What makes the validator of a word when a case first has it: most cases have few words."""

    def __init__(self, words: Any):
        self.words = words

    @cached_property
    def _adapter(self):
        from pydantic import TypeAdapter

        return TypeAdapter(self.words)

    def __get_pydantic_core_schema__(self, source, handler):
        from pydantic_core import core_schema

        return core_schema.no_info_plain_validator_function(
            lambda value: self._adapter.validate_python(value)
        )

    def __get_pydantic_json_schema__(self, schema, handler):
        return handler(self._adapter.core_schema)
