"""Building blocks of the case model: numbers, names, vectors, quantities with a dimension."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    WithJsonSchema,
)

from rodsim.case.expressions import Expression, reserved_name

MOST_POINTS = 10_000_000
BYTES_PER_POINT = 800  # state, loads, velocities and the integrator's work arrays, all float64

DIMENSIONS = {  # exponents of (mass, length, time)
    "length": (0, 1, 0),
    "time": (0, 0, 1),
    "viscosity": (1, -1, -1),
    "density": (1, -3, 0),
    "bending": (1, 3, -2),
    "force": (1, 1, -2),
    "stiffness": (1, 0, -2),
    "velocity": (0, 1, -1),
    "curvature": (0, -1, 0),
    "pressure": (1, -1, -2),
}
ANGLES = {"angle": "rad", "degrees": "degree"}


SMALLEST, LARGEST = 1e-200, 1e200


class Model(BaseModel):
    """A section of the case file: immutable, no unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=False, defer_build=True)


def quantity(dimension: str, description: str, **more: Any) -> Any:
    """Return a pydantic field with a dimension (of DIMENSIONS or ANGLES) and a description."""
    return Field(description=description, json_schema_extra={"dimension": dimension}, **more)


def no_larger_than_memory(points: int) -> int:
    """Return the number of points; raise ValueError where no machine could hold them."""
    if points > MOST_POINTS:
        gigabytes = points * BYTES_PER_POINT / 1e9
        raise ValueError(f"must be <= {MOST_POINTS}: would need about {gigabytes:.3g} GB")
    return points


def not_empty(entries: Any) -> Any:
    """Return the entries; raise ValueError if there are none."""
    if not entries:
        raise ValueError("must not be empty")
    return entries


def not_reserved(name: str) -> str:
    """Return the name of a parameter; raise ValueError where expressions use it already."""
    reason = reserved_name(name)
    if reason:
        raise ValueError(reason)
    return name


def not_zero(number: float) -> float:
    """Return the number; raise ValueError if it is 0."""
    if number == 0.0:
        raise ValueError("must not be 0")
    return number


def in_range(number: float) -> float:
    """Return the number; raise ValueError where sums and ratios of such numbers have no float64."""
    if not SMALLEST <= number <= LARGEST:
        raise ValueError(f"must be between {SMALLEST:g} and {LARGEST:g}")
    return number


def positive(value: Any) -> Any:
    """Return a modulus; raise ValueError if it is a number that is not > 0.

    Expressions are checked where they are computed.
    """
    if isinstance(value, Expression):
        return value
    if not value > 0.0:
        raise ValueError("must be > 0")
    return in_range(value)


def not_null(vector: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return the vector; raise ValueError if it has no direction."""
    if not any(vector):
        raise ValueError("must not be the null vector")
    return vector


class ScopedText(str):
    """The text of an expression with the numbers of the parameters where it stands."""

    parameters: Mapping[str, float]

    def __new__(cls, text: str, parameters: Mapping[str, float]):
        """Return the text with its parameters."""
        made = super().__new__(cls, text)
        made.parameters = parameters
        return made


def expression_in(*variables: str) -> Any:
    """Return the type of a key whose text is an expression in variables and the parameters.

    One that needs none of the variables is the number it comes to.
    """

    def bound(text: str) -> Expression | float:
        expression = Expression(text, getattr(text, "parameters", {}), variables)
        return expression if expression.uses else expression.constant

    words = f"expression in {', '.join(variables)} and the parameters"
    schema = WithJsonSchema({"type": "string", "description": words})
    return Annotated[Any, PlainValidator(bound), schema]


Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]
ParameterName = Annotated[Name, AfterValidator(not_reserved)]
UnitName = Annotated[str, Field(pattern=r"^[A-Za-zµμ\u00c5\u212b]{1,12}$")]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0), AfterValidator(in_range)]
NotNegative = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0)]
NotZero = Annotated[
    Number, AfterValidator(not_zero), WithJsonSchema({"type": "number", "not": {"const": 0}})
]
Flag = Annotated[bool, Field(strict=True)]
Integer = Annotated[int, Field(strict=True)]
Count = Annotated[int, Field(strict=True, ge=1), AfterValidator(no_larger_than_memory)]
Seed = Annotated[int, Field(strict=True, ge=0, lt=2**63)]
OpenPoints = Annotated[int, Field(strict=True, ge=2), AfterValidator(no_larger_than_memory)]
ClosedPoints = Annotated[int, Field(strict=True, ge=3), AfterValidator(no_larger_than_memory)]
Vector = tuple[Number, Number, Number]
Direction = Annotated[Vector, AfterValidator(not_null)]


def tag_of(value: Any) -> str:
    """Return the tag of the one member of a union that a value of this kind is meant to be.

    So a wrong value gives one message, not one per member of the union.
    """
    if isinstance(value, dict):
        return "<mapping>"
    if isinstance(value, list | tuple):
        return "<list>"
    return "<text>" if isinstance(value, str) else "<number>"


def text_tag(value: Any) -> str:
    """Like ``tag_of``, for unions that have no member for a number."""
    tag = tag_of(value)
    return "<list>" if tag == "<number>" else tag


def number_tag(value: Any) -> str:
    """Like ``tag_of``, for unions that have no member for text."""
    tag = tag_of(value)
    return "<number>" if tag == "<text>" else tag


def number_or(expression: Any) -> Any:
    """Return the type of a key that is a number or an expression of some variables."""
    return Annotated[
        Annotated[Number, Tag("<number>")] | Annotated[expression, Tag("<text>")],
        Discriminator(tag_of),
    ]


ExpressionText = expression_in("s", "t")
NumberOrExpression = number_or(ExpressionText)
Column = Annotated[
    Annotated[int, Field(strict=True, ge=1), Tag("<number>")]
    | Annotated[str, Field(min_length=1), Tag("<text>")],
    Discriminator(tag_of),
]
ModulusText = Annotated[expression_in("s"), AfterValidator(positive)]
Modulus = Annotated[
    Annotated[Positive, Tag("<number>")] | Annotated[ModulusText, Tag("<text>")],
    Discriminator(tag_of),
]
ModulusOrPair = Annotated[
    Annotated[Positive, Tag("<number>")]
    | Annotated[ModulusText, Tag("<text>")]
    | Annotated[tuple[Modulus, Modulus], Tag("<list>")],
    Discriminator(tag_of),
]
