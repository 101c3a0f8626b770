"""JSON Schema of the case file, for editors that complete and check as one types."""

from __future__ import annotations

from typing import Any

from rodsim.case.model import Case

DRAFT = "http://json-schema.org/draft-07/schema#"  # the newest that editors' YAML plugins know


def case_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft-07) of the case file as people write it."""
    schema = _with_expressions(model_schema())
    models = schema["definitions"]
    models["RodLike"] = _like_another(models["Rod"])
    rods = schema["properties"]["rods"]["patternProperties"]
    for pattern, rod in rods.items():
        like = {"$ref": "#/definitions/RodLike"}
        rods[pattern] = {"if": {"required": ["like"]}, "then": like, "else": rod}
    moduli = models["Moduli"]
    whole = moduli.pop("required")
    moduli["anyOf"] = [{"required": ["young", "radius"]}, {"required": whole}]
    return schema


def model_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft-07) of the case with all numbers and copies worked out."""
    return {"$schema": DRAFT, **_to_draft_07(Case.model_json_schema())}


def _with_expressions(node: Any) -> Any:
    """Return a schema that takes a text wherever it takes a number."""
    if isinstance(node, list):
        taken = [item.get("type") for item in node if isinstance(item, dict)]
        return node if "string" in taken else [_with_expressions(item) for item in node]
    if not isinstance(node, dict):
        return node
    changed = {key: _with_expressions(item) for key, item in node.items()}
    if changed.get("type") in ("number", "integer"):
        changed["type"] = [changed["type"], "string"]
    return changed


def _like_another(rod: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of a rod that need not say all, because it is like another."""
    changed = {key: item for key, item in rod.items() if key != "required"}
    parts = {
        name: {"type": "object", "description": rod["properties"][name]["description"]}
        for name in ("shape", "moduli")
    }
    return {**changed, "properties": {**rod["properties"], **parts}}


def _to_draft_07(node: Any) -> Any:
    """Return pydantic's schema (2020-12) with the keywords of draft-07, names checked as we do."""
    if isinstance(node, list):
        return [_to_draft_07(item) for item in node]
    if isinstance(node, str):
        return node.replace("#/$defs/", "#/definitions/")
    if not isinstance(node, dict):
        return node
    names = {"$defs": "definitions", "prefixItems": "items"}
    closed = {"additionalProperties": False} if "patternProperties" in node else {}
    return {names.get(key, key): _to_draft_07(item) for key, item in node.items()} | closed
