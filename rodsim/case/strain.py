"""What an entry of ``strain_twist`` may be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

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

    component: ClassVar[None] = None

    table: str = Field(
        min_length=1, description="file: columns s and value, or times in the first row"
    )
    columns: Annotated[tuple[Column, ...], Field(min_length=2, max_length=3)] | None = Field(
        None, description="names, or numbers from 1 on, of s, t where there is one, the value"
    )
    period: Positive | None = quantity("time", "over s and t: repeats itself", default=None)


class StrainTables(Model):
    """All three components from one table over s, or over s and t, splined (docs/data.md)."""

    table: str = Field(
        min_length=1, description="file: columns s, t where there is one, Omega_1, Omega_2, Omega_3"
    )
    columns: Annotated[tuple[Column, ...], Field(min_length=4, max_length=5)] | None = Field(
        None, description="names, or numbers from 1 on, of these columns"
    )
    period: Positive | None = quantity("time", "over s and t: repeats itself", default=None)

    @property
    def entries(self) -> tuple[OneOfThree, ...]:
        """Omega_1, Omega_2, Omega_3."""
        shared = self.table, self.columns, self.period
        return tuple(OneOfThree(*shared, component) for component in range(3))


@dataclass(frozen=True)
class OneOfThree:
    """One component of a table of all three, where a :class:`StrainTable` may stand."""

    table: str
    columns: tuple | None
    period: float | None
    component: int


TABLES = (StrainTable, OneOfThree)
StrainEntry = Annotated[
    Annotated[Number, Tag("<number>")]
    | Annotated[expression_in(*VARIABLES), Tag("<text>")]
    | Annotated[StrainTable, Tag("<mapping>")],
    Discriminator(tag_of),
]
OWN = tuple(Expression(name, {}, VARIABLES) for name in NATURAL)
