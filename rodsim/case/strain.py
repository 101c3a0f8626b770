"""What an entry of ``strain_twist`` may be."""

from __future__ import annotations

from typing import Annotated

from pydantic import Discriminator, Field, Tag

from rodsim.case.expressions import NATURAL, Expression
from rodsim.case.fields import (
    Column,
    Model,
    Number,
    Positive,
    expression_in,
    quantity,
    tag_of,
)

VARIABLES = ("s", "t", *NATURAL)


class StrainTable(Model):
    """A strain twist from a table over s, or over s and t, splined (docs/data.md)."""

    table: str = Field(
        min_length=1, description="file: columns s and value, or times in the first row"
    )
    columns: tuple[Column, Column] | None = Field(
        None, description="names, or numbers from 1 on, of s and the value"
    )
    period: Positive | None = quantity("time", "over s and t: repeats itself", default=None)


StrainEntry = Annotated[
    Annotated[Number, Tag("<number>")]
    | Annotated[expression_in(*VARIABLES), Tag("<text>")]
    | Annotated[StrainTable, Tag("<mapping>")],
    Discriminator(tag_of),
]
OWN = tuple(Expression(name, {}, VARIABLES) for name in NATURAL)
