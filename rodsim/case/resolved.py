"""A case as plain data: what the output file keeps, and a sweep writes for each run."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from rodsim.case.expressions import Expression


def resolved(case: Any) -> dict[str, Any]:
    """Return what ``Case.resolved`` does."""
    data = _plain(case)
    data["output"]["interval"] = case.interval
    if case.units.force is not None:
        del data["units"]["mass"]
    for rod in data["rods"].values():
        if not rod["parameters"]:  # as in files from before rods had any
            del rod["parameters"]
    if not case.time.method.adaptive:
        del data["time"]["tolerance"]
    return data


def is_driven(value: Any) -> bool:
    """Tell whether anything in a model depends on time."""
    if isinstance(value, Expression):
        return value.uses_t
    if isinstance(value, BaseModel):
        value = {name: getattr(value, name) for name in type(value).model_fields}
    if isinstance(value, dict):
        value = tuple(value.values())
    return isinstance(value, tuple) and any(map(is_driven, value))


def _plain(value: Any) -> Any:
    """Return a model as dicts, lists and scalars; what is None is left out."""
    if isinstance(value, BaseModel):
        value = {name: getattr(value, name) for name in type(value).model_fields}
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items() if item is not None}
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return value.text if isinstance(value, Expression) else value
