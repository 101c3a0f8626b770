"""JSON Schema of the case file, for editors that complete and check as one types."""

from __future__ import annotations

from typing import Any

from rodsim.case.model import Case

DRAFT = "http://json-schema.org/draft-07/schema#"  # the newest that editors' YAML plugins know


def case_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft-07) of the case file as people write it."""
    schema = _with_expressions(model_schema())
    models = schema["definitions"]
    models |= _partial(models, "Rod")
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


def _partial(models: dict[str, Any], name: str) -> dict[str, Any]:
    """Return a model and all below it as they may stand in a rod that is like another: ...Like.

    Nothing is required, for the other rod may say it; of a union any member that fits will do.
    """
    made, wanted = {}, [name]
    while wanted:
        model = wanted.pop()
        if f"{model}Like" not in made:
            made[f"{model}Like"] = _without_required(models[model], wanted)
    return made


def _without_required(node: Any, wanted: list[str]) -> Any:
    """Return a schema that requires no key; models that it refers to are added to ``wanted``."""
    if isinstance(node, list):
        return [_without_required(item, wanted) for item in node]
    if not isinstance(node, dict):
        return node
    kept = {key: item for key, item in node.items() if key not in ("required", "discriminator")}
    changed = {"anyOf" if key == "oneOf" else key: _without_required(item, wanted)
               for key, item in kept.items()}  # fmt: skip
    if "$ref" in changed:
        wanted.append(changed["$ref"].rpartition("/")[2])
        changed["$ref"] += "Like"
    return changed


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
    changed = {names.get(key, key): _to_draft_07(item) for key, item in node.items()} | closed
    if all("$ref" in item or item == {"type": "null"} for item in changed.get("anyOf", [{}])):
        changed.pop("title", None)  # what is referred to has one
    return changed
