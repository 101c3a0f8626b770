"""Writes docs/case-file.md from the model of the case file: ``python docs/case_reference.py``."""

from __future__ import annotations

import json
from pathlib import Path

from rodsim.case import Case, template
from rodsim.case.expressions import FUNCTIONS
from rodsim.case.fields import ANGLES, DIMENSIONS
from rodsim.case.model import Units
from rodsim.case.schema import model_schema
from rodsim.units import unit_text

PAGE = Path(__file__).with_name("case-file.md")
HEAD = """# The case file

<!-- Made by docs/case_reference.py from the model that also checks case files. Do not edit. -->

A case is a YAML file that says all about a scene. `rodsim new ring case.yaml` writes one to start
from, `rodsim validate case.yaml` reports every problem at once, with its line, and the option
`--set key=value` changes a key for one run (`--set rods.ring.shape.points=100`, or `--set
tracers=null` to take a key out).

* Units are those of the default names, um, g and s. With other names in `units` the numbers mean
  those: nothing is converted.
* `1e-3` is a number, `no` is text, a key that is unknown or given twice is an error.
* Any number may be an [expression](numbers.md) of the parameters: `end: 5*period`.
* A rod that is [like another](numbers.md#rods-like-others) need not say what it has from there.
* A key left empty, or set to `null`, takes its default.
* Numbers that must be > 0 must also lie between 1e-200 and 1e200; nothing has more than 10⁷ points.
"""
SECTIONS = {
    "Case": "Top level",
    "Units": "units",
    "Fluid": "fluid",
    "Spacings": "fluid.epsilon with spacings",
    "Radius": "fluid.epsilon with radius",
    "Wall": "fluid.wall",
    "Sums": "fluid.sums",
    "Rod": "rods.NAME",
    "Perturb": "rods.NAME.perturb",
    "Moduli": "rods.NAME.moduli",
    "StrainTables": "rods.NAME.strain_twist as a mapping",
    "StrainTable": "rods.NAME.strain_twist.N as a mapping",
    "Load": "rods.NAME.loads.NAME",
    "Straight": "rods.NAME.shape, kind: straight",
    "Ring": "rods.NAME.shape, kind: ring",
    "Helix": "rods.NAME.shape, kind: helix",
    "Sine": "rods.NAME.shape, kind: sine",
    "FileShape": "rods.NAME.shape, kind: file",
    "CurveShape": "rods.NAME.shape, kind: curve",
    "Rotate": "rods.NAME.shape.rotate",
    "Tether": "tethers.NAME",
    "Contact": "contact",
    "Epsilons": "contact.diameter with epsilons",
    "OnRod": "an end of a tether on a rod",
    "OnBody": "an end of a tether on a body",
    "Body": "bodies.NAME",
    "Sphere": "bodies.NAME.shape, kind: sphere",
    "Spheroid": "bodies.NAME.shape, kind: spheroid",
    "Spherocylinder": "bodies.NAME.shape, kind: spherocylinder",
    "FileSurface": "bodies.NAME.shape, kind: file",
    "Motion": "bodies.NAME.motion as a mapping",
    "End": "rods.NAME.start, rods.NAME.end",
    "Move": "rods.NAME.start.move",
    "Motor": "rods.NAME.start.motor",
    "Hook": "rods.NAME.start.hook",
    "Tube": "tracers.NAME as a mapping",
    "Time": "time",
    "Output": "output",
    "Initial": "initial",
    "Rest": "rest",
}
LAST = ("rotate", "origin")  # keys that all shapes share
TAIL = """## Expressions

Any number may be an expression of `pi` and the names in `parameters`; the entries of
`strain_twist`, and of forces and torques in `loads`, of the arc length `s` and the time `t` as
well, moduli of `s`, those of `fluid.flow` of `x`, `y`, `z`, `t`; with `+ - * / ** %`, the
comparisons `< <= > >=` and the functions
{functions};
`where(condition, a, b)` chooses, `arctan2(y, x)` is an angle, `heaviside(0)` is 1/2; more in
[numbers](numbers.md).

The first point of a rod is at s = 0; strain twist is taken at the
middle of each segment. Nothing in a case file can run code.

abs(Omega) times the spacing must be at most 2 (no discrete rod has more strain twist at rest);
above 1 there is a warning.

## A whole case

What `rodsim new ring` writes:

```yaml
{example}```
"""


def page() -> str:
    """Return the text of the page."""
    schema = model_schema()
    models = {
        "Case": {**schema, "description": Case.__doc__.split("\n")[0]},
        **schema["definitions"],
    }
    if missing := models.keys() - SECTIONS:
        raise SystemExit(f"SECTIONS lacks {', '.join(sorted(missing))}")
    sections = [_section(title, models[name]) for name, title in SECTIONS.items()]
    functions = ", ".join(f"`{name}`" for name in FUNCTIONS)
    tail = TAIL.format(functions=functions, example=template("ring"))
    return "\n".join([HEAD, *sections, tail])


def _section(title, model):
    rows = [f"## {title}", "", model["description"], ""]
    rows += ["| key | value | unit | default | meaning |", "|---|---|---|---|---|"]
    fields = sorted(
        model["properties"].items(), key=lambda item: (item[0] in LAST, item[0] != "kind")
    )
    for key, field in fields:
        unit, default = _unit(field.get("dimension")), _default(key, field, model)
        meaning = field.get("description", "as the title says")
        rows.append(f"| `{key}` | {_value(field)} | {unit} | {default} | {meaning} |")
    return "\n".join([*rows, ""])


def _value(schema):
    """Return in words what a JSON Schema accepts."""
    if "$ref" in schema:
        title = SECTIONS[schema["$ref"].rpartition("/")[2]]
        return f"[{title.rpartition('NAME.')[2]}](#{_anchor(title)})"
    if members := schema.get("oneOf") or schema.get("anyOf"):
        return " or ".join(_value(m) for m in members if m.get("type") != "null")
    if "const" in schema:
        return f"`{schema['const']}`"
    if "enum" in schema:
        return " or ".join(f"`{word}`" for word in schema["enum"])
    return _typed(schema)


def _typed(schema):
    kind = schema["type"]
    if kind == "object":
        return f"a mapping of names to: {_value(*schema['patternProperties'].values())}"
    if kind == "array" and isinstance(schema["items"], list):
        return f"list of {len(schema['items'])}: {_value(schema['items'][0])}"
    if kind == "array":
        return f"list of: {_value(schema['items'])}"
    words = {"integer": "whole number", "string": "text", "boolean": "true or false"}
    return " ".join([words.get(kind, kind), *_bounds(schema)])


def _bounds(schema):
    signs = {"exclusiveMinimum": ">", "minimum": "≥", "exclusiveMaximum": "<", "maximum": "≤"}
    found = [f"{sign} {schema[name]:g}" for name, sign in signs.items() if name in schema]
    return [" and ".join(found)] * bool(found) + ["≠ 0"] * ("not" in schema)


def _unit(dimension):
    if dimension is None:
        return ""
    if dimension in ANGLES:
        return ANGLES[dimension]
    return unit_text(DIMENSIONS[dimension], Units().model_dump()).replace("um", "µm")


def _default(key, field, model):
    if key in model.get("required", ()):
        return "required"
    default = field.get("default")
    if isinstance(default, dict):
        return "its defaults" if default else "none"
    return "none" if default is None else f"`{json.dumps(default)}`"


def _anchor(title):
    """Return the anchor that renderers of Markdown make of a title."""
    kept = "".join(c for c in title.lower() if c.isalnum() or c in " -_")
    return kept.replace(" ", "-")


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
