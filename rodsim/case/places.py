"""What the model knows at a path of the case file: keys, dimension, and the words for them."""

from __future__ import annotations

from dataclasses import dataclass
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from rodsim.case.fields import Model
from rodsim.case.words import one_of

_NOUNS = {
    float: ("a number", "numbers"),
    int: ("a whole number", "whole numbers"),
    str: ("text", "texts"),
    bool: ("true or false", "true or false"),
    Any: ("an expression", "expressions"),
}


@dataclass(frozen=True)
class Place:
    """One place of the case file: what the model expects there."""

    annotation: Any
    dimension: str = ""
    default: Any = None

    def models(self, value: Any = None) -> list[type[Model]]:
        """Return the models that may stand here, narrowed by the value's ``kind``."""
        models = [member for member in _members(self.annotation) if _is_model(member)]
        kind = value.get("kind") if isinstance(value, dict) else None
        return [model for model in models if kind in _kinds([model])] or models

    def keys(self, value: Any = None) -> list[str]:
        """Return the keys a mapping may have here."""
        return list(dict.fromkeys(key for m in self.models(value) for key in m.model_fields))

    def kinds(self) -> list[str]:
        """Return the values ``kind`` may have here."""
        return _kinds(self.models())

    def choices(self) -> list[str]:
        """Return the words allowed here, if it is one of a few."""
        members = [m for m in _members(self.annotation) if get_origin(m) is Literal]
        return [str(word) for member in members for word in get_args(member)]

    def noun(self) -> str:
        """Return what is wanted here: ``a number or a list of 2 numbers``."""
        kinds = self.kinds()
        start = [f"a mapping with kind: {one_of(kinds)}"] if kinds else []
        others = [m for m in _members(self.annotation) if not (_is_model(m) and _kinds([m]))]
        return one_of(start + [_noun(member) for member in others])

    def takes_expressions(self) -> bool:
        """Whether a text here stays an expression, of variables such as s and t."""
        return Any in _members(self.annotation)

    def takes_numbers(self) -> bool:
        """Whether a number may stand here, and no text of another meaning."""
        members = _members(self.annotation)
        return (float in members or int in members) and str not in members

    def takes_whole_numbers(self) -> bool:
        """Whether it is whole numbers that may stand here."""
        members = _members(self.annotation)
        return int in members and float not in members

    def child(self, key: str | int, value: Any = None) -> Place | None:
        """Return the place one key further, or None where the model has no such key."""
        for model in self.models(value):
            if key in model.model_fields:
                field = model.model_fields[key]
                extra = field.json_schema_extra or {}
                return Place(field.annotation, extra.get("dimension", ""), field.default)
        for member in _members(self.annotation):
            arguments = get_args(member)
            if get_origin(member) is dict and isinstance(key, str):
                return Place(arguments[1], self.dimension)
            if get_origin(member) is tuple and isinstance(key, int):
                return Place(arguments[0], self.dimension)
        return None


def named(place: Place) -> bool:
    """Whether the keys here are the user's own names: rods, tracers, parameters."""
    return any(get_origin(member) is dict for member in _members(place.annotation))


def _members(annotation: Any) -> list[Any]:
    """Return the alternatives of an annotation, without None."""
    if get_origin(annotation) is Annotated:
        return _members(get_args(annotation)[0])
    if get_origin(annotation) in (Union, UnionType):
        return [m for part in get_args(annotation) for m in _members(part)]
    return [] if annotation is type(None) else [annotation]


def _is_model(member: Any) -> bool:
    return isinstance(member, type) and issubclass(member, Model)


def _kinds(models: list[type[Model]]) -> list[str]:
    fields = (model.model_fields.get("kind") for model in models)
    return [get_args(field.annotation)[0] for field in fields if field is not None]


def _noun(member: Any, plural: bool = False) -> str:
    if member in _NOUNS:
        return _NOUNS[member][plural]
    many = "lists" if plural else "a list"
    if get_origin(member) is Literal:
        words = get_args(member)
        return f"one of {', '.join(words)}" if len(words) > 1 else words[0]
    if get_origin(member) is dict:
        return "a mapping of names"
    if get_origin(member) is tuple:
        parts = get_args(member)
        size = "" if parts[-1] is Ellipsis else f"{len(parts)} "
        return f"{many} of {size}{one_of([_noun(m, True) for m in _members(parts[0])])}"
    return f"{'mappings' if plural else 'a mapping'} with {', '.join(member.model_fields)}"
