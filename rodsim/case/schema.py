"""JSON Schema of the case file, for editors that complete and check as one types."""

from __future__ import annotations

from typing import Any

from rodsim.case.model import Case

DRAFT = "http://json-schema.org/draft-07/schema#"  # the newest that editors' YAML plugins know


def case_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft-07) of the case file."""
    return {"$schema": DRAFT, **_to_draft_07(Case.model_json_schema())}


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
