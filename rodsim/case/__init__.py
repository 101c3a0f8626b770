"""Case files: YAML with line numbers -> a validated, immutable Case.

Each name is loaded on first use: the words of a case come from the parts of a scene, which need
the fields of this package and not the model made of them.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rodsim.case.load import load_case as load_case
    from rodsim.case.model import Case as Case

_HOMES = {
    "TEMPLATES": "templates",
    "Case": "model",
    "Expression": "expressions",
    "ExpressionError": "expressions",
    "case_from_mapping": "load",
    "case_schema": "schema",
    "check_strain_twist": "check",
    "load_case": "load",
    "spacings_differ": "check",
    "template": "templates",
    "thin": "check",
}
__all__ = list(_HOMES)


def __getattr__(name: str):
    if name not in _HOMES:
        raise AttributeError(f"module 'rodsim.case' has no attribute {name!r}")
    return getattr(import_module(f"rodsim.case.{_HOMES[name]}"), name)
