"""``kind: curve``: a centreline from a table or from expressions."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, create_model, model_validator

from rodsim.case.fields import (
    Column,
    Flag,
    Integer,
    NotNegative,
    Number,
    OpenPoints,
    Positive,
    UnitName,
    expression_in,
    number_or,
    quantity,
)
from rodsim.case.placed import FromFile


class CurveBase(FromFile):
    """A centreline without triads, made even and framed by parallel transport (docs/data.md)."""

    kind: Literal["curve"]
    path: str | None = Field(None, min_length=1, description="table of its points; or position")
    position: tuple[(number_or(expression_in("u")),) * 3] | None = quantity(
        "length", "x, y, z as expressions in u; or path", default=None
    )
    points: OpenPoints | None = Field(
        None,
        description="of the rod, at equal arc steps; default: as many as the table has, or as "
        "fit spacing",
    )
    columns: tuple[Column, ...] | None = Field(
        None,
        min_length=2,
        max_length=3,
        description="of a table: names, or numbers from 1 on, of x y z, or of x y (z is 0)",
    )
    frame: Integer | None = Field(None, description="of a table: frame of several; -1 is the last")
    rod: Column | None = Field(
        None, description="of a table: which rod of several: its name, or its number from 1 on"
    )
    unit: UnitName | None = Field(None, description="of a table's lengths, if not the case's")
    closed: Flag = Field(False, description="join the end to the beginning")
    smoothing: NotNegative = quantity(
        "length", "root mean square distance the curve may keep from its points", default=0.0
    )
    length: Positive | None = quantity(
        "length", "length at rest; default: the curve's own", default=None
    )
    spacing: Positive | None = quantity(
        "length", "spacing at rest; default: the curve's own", default=None
    )
    turns: Number = Field(
        0.0, description="turns of the triads about the curve, beside parallel transport"
    )
    as_is: Flag = Field(False, description="take it also where something contradicts")

    @model_validator(mode="after")
    def _one_of_each(self):
        if (self.path is None) == (self.position is None):
            raise ValueError("give path or position" + (", not both" if self.path else ""))
        if self.length is not None and self.spacing is not None:
            raise ValueError("give length or spacing, not both")
        if self.closed and self.points == 2:
            raise ValueError("a closed rod has at least 3 points")
        if self.position is None:
            return self._only_for("position", "from", "to")
        begin, end = self.range
        if begin is None or end is None:
            raise ValueError("position needs from and to: where u begins and ends")
        if begin == end:
            raise ValueError("from and to must differ")
        if self.points is None and self.spacing is None:
            raise ValueError("position needs points, or spacing")
        return self._only_for("path", "columns", "frame", "rod", "unit")

    def _only_for(self, key, *others):
        given = [name for name in others if getattr(self, name) is not None]
        if given:
            raise ValueError(f"{', '.join(given)}: only beside {key}")
        return self

    @property
    def range(self) -> tuple[float | None, float | None]:
        """Where u begins and ends."""
        return tuple(getattr(self, name) for name in ("from", "to"))

    @property
    def is_closed(self) -> bool:
        """Whether the end is joined to the beginning."""
        return self.closed

    @property
    def segments(self) -> int | None:
        """Number of segments, or None where only a file or the curve's length knows it."""
        return None if self.points is None else self.points - (not self.closed)


CurveShape = create_model(  # "from" cannot be written as an attribute
    "CurveShape",
    __base__=CurveBase,
    __doc__=CurveBase.__doc__,
    **{
        "from": (Number | None, Field(None, description="of position: u at the beginning")),
        "to": (Number | None, Field(None, description="of position: u at the end")),
    },
)
