"""Words of the case file for what holds and drives rods: ``bodies``, and ``start``, ``end``."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from rodsim.blocks.surface import FEWEST, MOST
from rodsim.case.expressions import Expression
from rodsim.case.fields import (
    Column,
    Direction,
    Flag,
    Model,
    Name,
    NotZero,
    NumberOrExpression,
    Positive,
    UnitName,
    Vector,
    quantity,
    tag_of,
)
from rodsim.case.placed import Rotate


def _of_time(value: Any) -> Any:
    """Return a number or an expression in t; raise ValueError where it depends on s."""
    if isinstance(value, Expression) and value.uses_s:
        raise ValueError("depends on t alone: there is no s here")
    return value


OfTime = Annotated[NumberOrExpression, AfterValidator(_of_time)]
Triple = tuple[OfTime, OfTime, OfTime]
NOTHING = (0.0, 0.0, 0.0)


def _even(points: int) -> int:
    if points % 2:
        raise ValueError("must be even: half of the points mirror the others through the centre")
    return points


Points = Annotated[int, Field(strict=True, ge=FEWEST, le=MOST), AfterValidator(_even)]


class Surface(Model):
    """What all shapes of bodies share; they are built about 0 with their axis along z."""

    rotate: Rotate | None = Field(None, description="turn about the origin, done first")
    origin: Vector = quantity("length", "then the body is moved by this", default=NOTHING)


class _OfRevolution(Surface):
    points: Points = Field(100, description="points of the surface: its one knob of accuracy")


class Sphere(_OfRevolution):
    """A sphere."""

    kind: Literal["sphere"]
    radius: Positive = quantity("length", "its radius")


class Spheroid(_OfRevolution):
    """An ellipsoid of revolution, long or flat."""

    kind: Literal["spheroid"]
    length: Positive = quantity("length", "from pole to pole")
    radius: Positive = quantity("length", "at the equator")


class Spherocylinder(_OfRevolution):
    """A cylinder with a half sphere at each end."""

    kind: Literal["spherocylinder"]
    length: Positive = quantity("length", "from pole to pole")
    radius: Positive = quantity("length", "of the cylinder and of the half spheres")

    @model_validator(mode="after")
    def _long_enough(self):
        if self.length < 2.0 * self.radius:
            raise ValueError("length must be at least 2 radius: the half spheres are part of it")
        return self


class FileSurface(Surface):
    """A closed surface of any shape, from a table of its points: the more the better."""

    kind: Literal["file"]
    path: str = Field(min_length=1, description="table of points x y z on the surface")
    columns: tuple[Column, Column, Column] | None = Field(
        None, description="names, or numbers from 1 on, of x y z"
    )
    unit: UnitName | None = Field(None, description="of the table's lengths, if not the case's")


def _kind_tag(value: Any) -> str | None:
    kind = value.get("kind") if isinstance(value, dict) else getattr(value, "kind", None)
    return f"<{kind}>" if isinstance(kind, str) else None


BodyShape = Annotated[
    Annotated[Sphere, Tag("<sphere>")]
    | Annotated[Spheroid, Tag("<spheroid>")]
    | Annotated[Spherocylinder, Tag("<spherocylinder>")]
    | Annotated[FileSurface, Tag("<file>")],
    Discriminator(_kind_tag),
]


class Motion(Model):
    """A given motion of a body: its velocity, and how it turns."""

    velocity: Triple = quantity("velocity", "of its centre", default=NOTHING)
    turn: Triple | None = Field(
        None, description="rotation vector from where it starts (rad), as in move of a rod's end"
    )
    spin: Triple | None = Field(None, description="or its angular velocity (1/time)")

    @model_validator(mode="after")
    def _one_turn(self):
        if self.turn is not None and self.spin is not None:
            raise ValueError("give turn or spin, not both")
        return self


class Body(Model):
    """A rigid body in the fluid."""

    shape: BodyShape = Field(description="its surface")
    motion: Annotated[
        Annotated[Literal["free", "fixed"], Tag("<text>")] | Annotated[Motion, Tag("<mapping>")],
        Discriminator(tag_of),
    ] = Field("free", description="free, fixed, or a given motion")
    force: Triple = Field(NOTHING, description="on the body (mass length time^-2), may depend on t")
    torque: Triple = Field(NOTHING, description="about its centre (mass length^2 time^-2)")


class Move(Model):
    """A given motion of what holds a rod's end, from where it starts."""

    displace: Triple = quantity("length", "displacement, may depend on t", default=NOTHING)
    turn: Triple = quantity("angle", "rotation vector, may depend on t", default=NOTHING)


class Motor(Model):
    """A motor between what holds a rod's end and the rod: it turns the end about an axis."""

    rate: OfTime | None = Field(None, description="given rate (rad/time), may depend on t")
    torque: OfTime | None = Field(None, description="or given torque on the rod, may depend on t")
    free_rate: NotZero | None = Field(
        None, description="with a number for torque: the rate at which it has none left (a line)"
    )
    axis: Direction | None = Field(
        None, description="axis, fixed to the holder; default the tangent D3 of the end"
    )

    @model_validator(mode="after")
    def _one_drive(self):
        if (self.rate is None) == (self.torque is None):
            raise ValueError("give rate or torque" + (", not both" if self.rate else ""))
        if self.free_rate is not None and not isinstance(self.torque, float | int):
            raise ValueError("free_rate goes with a number for torque")
        if self.free_rate is not None and not self.torque * self.free_rate > 0.0:
            raise ValueError("free_rate must have the sign of torque")
        return self


class Hook(Model):
    """A torsion spring between what holds a rod's end and the rod."""

    bending: Positive = Field(description="torque per angle: EI/length (mass length^2 time^-2)")
    twisting: Annotated[
        Annotated[Positive, Tag("<number>")] | Annotated[Literal["stiff"], Tag("<text>")],
        Discriminator(tag_of),
    ] = Field("stiff", description="torque per angle of twist: GJ/length, or stiff")


class End(Model):
    """How the first or the last point of a rod is held."""

    hold: Literal["free", "hinged", "clamped"] = Field(
        "free", description="hinged: its place; clamped: its place and its triad"
    )
    to: Name = Field("space", description="a body, or space")
    move: Move | None = Field(None, description="a given motion of the holder, in space")
    motor: Motor | None = Field(None, description="turns the end about an axis of the holder")
    hook: Hook | None = Field(None, description="a torsion spring; without one the joint is stiff")
    gap: Flag = Field(False, description="let the end be farther than epsilon from the body")

    @model_validator(mode="after")
    def _together(self):
        given = [key for key in ("move", "motor", "hook") if getattr(self, key) is not None]
        if self.hold == "free" and (given or self.to != "space"):
            raise ValueError(f"hold: clamped is needed for {', '.join(given) or 'to'}")
        if self.hold == "hinged" and any(key != "move" for key in given):
            raise ValueError("hold: clamped is needed for a motor or a hook")
        if self.to != "space" and self.move is not None:
            raise ValueError(f"move is of an end held in space; {self.to} has a motion of its own")
        return self
