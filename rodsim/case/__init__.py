"""Case files: YAML with line numbers -> a validated, immutable Case."""

from rodsim.case.check import check_strain_twist, spacings_differ, thin
from rodsim.case.expressions import Expression, ExpressionError
from rodsim.case.load import case_from_mapping, load_case
from rodsim.case.model import Case
from rodsim.case.schema import case_schema
from rodsim.case.templates import TEMPLATES, template

__all__ = [
    "TEMPLATES",
    "Case",
    "Expression",
    "ExpressionError",
    "case_from_mapping",
    "case_schema",
    "check_strain_twist",
    "load_case",
    "spacings_differ",
    "template",
    "thin",
]
