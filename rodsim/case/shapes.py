"""The shapes a rod can start from, and what may disturb them; ``scene/`` makes points of them."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from rodsim.case.curve import CurveShape
from rodsim.case.fields import (
    ClosedPoints,
    Column,
    Count,
    Flag,
    Integer,
    Model,
    NotNegative,
    NotZero,
    Number,
    OpenPoints,
    Positive,
    Seed,
    UnitName,
    quantity,
)
from rodsim.case.placed import FromFile, Placed


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
    taper: Positive | None = quantity(
        "length", "starts on its axis: the radius grows as 1 - exp(-(z/taper)^2)", default=None
    )


class Sine(Placed):
    """A sine wave y(z) in the y-z plane, with D1 along x."""

    kind: Literal["sine"]
    amplitude: NotNegative = quantity("length", "largest abs(y)")
    wavelength: Positive = quantity("length", "period along z")
    phase: Number = quantity("angle", "phase at z = 0", default=0.0)
    points: OpenPoints = Field(description="number of points")
    length: Positive = quantity("length", "arc length")


class FileShape(FromFile):
    """Points and triads from an earlier output, or from a table x y z D1 D2 D3 (docs/data.md)."""

    kind: Literal["file"]
    path: str = Field(min_length=1, description="output file, table, or export")
    frame: Integer | None = Field(None, description="frame of several; -1 is the last")
    rod: Column | None = Field(
        None,
        description="which rod of several: its name, or its number from 1 on where it has none",
    )
    columns: tuple[Column, ...] | None = Field(
        None,
        min_length=12,
        max_length=12,
        description="of a table: names, or numbers from 1 on, of x y z D1 D2 D3",
    )
    unit: UnitName | None = Field(None, description="of a table's lengths, if not the case's")
    spacing: Positive | None = quantity("length", "rest spacing of a table's points", default=None)
    closed: Flag | None = Field(None, description="join the last point of a table to the first")
    as_is: Flag = Field(
        False, description="take it also where its points, triads and spacing contradict each other"
    )

    @property
    def is_closed(self) -> bool:
        """Whether a table is closed; an output file says it itself."""
        return bool(self.closed)


class Perturb(Model):
    """A smooth random displacement and twist of a rod's start, the same for the same seed."""

    amplitude: Positive = quantity("length", "root mean square displacement of the centreline")
    seed: Seed = Field(1, description="another number is another disturbance")
    modes: Count = Field(8, description="how many waves it is made of; the longest is the rod")


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
