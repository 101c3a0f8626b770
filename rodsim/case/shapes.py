"""The shapes a rod can start from. ``scene/`` turns them into points and triads."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, create_model, model_validator

from rodsim.case.fields import (
    ClosedPoints,
    Column,
    CurveNumber,
    Direction,
    Flag,
    Integer,
    Model,
    NotNegative,
    NotZero,
    Number,
    OpenPoints,
    Positive,
    Vector,
    quantity,
)


class Rotate(Model):
    """A turn about an axis through the origin, before the shape is moved to its place."""

    axis: Direction = Field(description="direction of the axis, of any length but 0")
    degrees: Number = quantity("degrees", "angle, right-handed about the axis")


class Placed(Model):
    """What all shapes share."""

    rotate: Rotate | None = Field(None, description="turn about the origin, done first")
    origin: Vector = quantity("length", "then the shape is moved by this", default=(0.0, 0.0, 0.0))

    @property
    def is_closed(self) -> bool:
        """Whether the last point is joined to the first."""
        return False

    @property
    def ds(self) -> float | None:
        """Arc length between neighbouring points, or None where only a file knows it."""
        return self.length / (self.points - 1)

    @property
    def segments(self) -> int | None:
        """Number of segments, or None where only a file knows it."""
        return self.points if self.is_closed else self.points - 1


class Straight(Placed):
    """A straight rod along +z from 0, stretched and tilted by the perturbation (eqs 40-43)."""

    kind: Literal["straight"]
    points: OpenPoints = Field(description="number of points")
    length: Positive | None = quantity("length", "arc length; or give spacing", default=None)
    spacing: Positive | None = quantity("length", "between points; or give length", default=None)
    perturbation: Number = Field(
        0.0,
        description="xi of eqs 40-43: stretched by 1 + xi, triads turned about x by xi rad",
    )

    @model_validator(mode="after")
    def _one_size(self):
        if (self.length is None) == (self.spacing is None):
            raise ValueError("give length or spacing" + (", not both" if self.length else ""))
        return self

    @property
    def ds(self) -> float:
        """Arc length between neighbouring points."""
        return self.length / (self.points - 1) if self.spacing is None else self.spacing


class Ring(Placed):
    """A circle in the plane z = 0, with the perturbed twist of eqs 46-49."""

    kind: Literal["ring"]
    radius: Positive = quantity("length", "radius of the circle")
    points: ClosedPoints = Field(description="number of points")
    twist_perturbation: Number = Field(
        0.0,
        description="xi of eqs 46-49: triads turned about the tangent by xi sin(s/radius) rad",
    )

    @property
    def is_closed(self) -> bool:
        """A ring is closed."""
        return True

    @property
    def ds(self) -> float:
        """Arc length between neighbouring points: 2 pi radius / points."""
        return 2.0 * math.pi * self.radius / self.points


class Helix(Placed):
    """A helix about the z axis: right-handed for pitch > 0, left-handed for pitch < 0."""

    kind: Literal["helix"]
    radius: Positive = quantity("length", "distance of the centreline from the axis")
    pitch: NotZero = quantity("length", "rise per turn; negative is left-handed")
    points: OpenPoints = Field(description="number of points")
    length: Positive = quantity("length", "arc length")


class Sine(Placed):
    """A sine wave y(z) in the y-z plane, with D1 along x."""

    kind: Literal["sine"]
    amplitude: NotNegative = quantity("length", "largest abs(y)")
    wavelength: Positive = quantity("length", "period along z")
    phase: Number = quantity("angle", "phase at z = 0", default=0.0)
    points: OpenPoints = Field(description="number of points")
    length: Positive = quantity("length", "arc length")


class FromFile(Placed):
    """What shapes that need a file share: what is known only once it is read."""

    @property
    def ds(self) -> None:
        """Not known before the file is read."""
        return None

    @property
    def segments(self) -> None:
        """Not known before the file is read."""
        return None


class FileShape(FromFile):
    """Points and triads from an earlier output, or from a table x y z D1 D2 D3 (docs/data.md)."""

    kind: Literal["file"]
    path: str = Field(min_length=1, description="output file, table, or export")
    frame: Integer | None = Field(None, description="frame of several; -1 is the last")
    rod: str | None = Field(None, description="which rod of several")
    columns: tuple[Column, ...] | None = Field(
        None,
        min_length=12,
        max_length=12,
        description="of a table: names, or numbers from 1 on, of x y z D1 D2 D3",
    )
    spacing: Positive | None = quantity("length", "rest spacing of a table's points", default=None)
    closed: Flag | None = Field(None, description="join the last point of a table to the first")
    as_is: Flag = Field(
        False, description="take it also where its points, triads and spacing contradict each other"
    )

    @property
    def is_closed(self) -> bool:
        """Whether a table is closed; an output file says it itself."""
        return bool(self.closed)


class CurveBase(FromFile):
    """A centreline without triads, made even and framed by parallel transport (docs/data.md)."""

    kind: Literal["curve"]
    path: str | None = Field(None, min_length=1, description="table of its points; or position")
    position: tuple[CurveNumber, CurveNumber, CurveNumber] | None = quantity(
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
    rod: str | None = Field(None, description="of a table: which rod of several")
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
        return self._only_for("path", "columns", "frame", "rod")

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


def _kind_tag(value: Any) -> str | None:
    kind = value.get("kind") if isinstance(value, dict) else getattr(value, "kind", None)
    return f"<{kind}>" if isinstance(kind, str) else None


Shape = Annotated[
    Annotated[Straight, Tag("<straight>")]
    | Annotated[Ring, Tag("<ring>")]
    | Annotated[Helix, Tag("<helix>")]
    | Annotated[Sine, Tag("<sine>")]
    | Annotated[FileShape, Tag("<file>")]
    | Annotated[CurveShape, Tag("<curve>")],
    Discriminator(_kind_tag),
]
