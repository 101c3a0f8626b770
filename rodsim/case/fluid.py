"""The section ``fluid`` of a case; kinds of parts add their words to it."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, ValidationInfo, field_validator

from rodsim.case.fields import Model, Positive, number_tag, quantity
from rodsim.case.materials import WIDTHS, Radius
from rodsim.case.source import child
from rodsim.registry import with_words


class Spacings(Model):
    """A length in units of the rods' common spacing."""

    spacings: Positive = Field(description="epsilon / ds")


@with_words
class Fluid(Model):
    """The fluid and the blob that spreads each point's load."""

    viscosity: Positive = quantity("viscosity", "dynamic viscosity")
    blob: Literal["algebraic7", "algebraic9"] = Field("algebraic7", description="eq. 12 or eq. 13")
    epsilon: Annotated[
        Annotated[Positive, Tag("<number>")]
        | Annotated[Spacings, Tag("<mapping>")]
        | Annotated[Radius, Tag("<radius>")],
        Discriminator(
            lambda value: "<radius>" if child(value, "radius") is not None else number_tag(value)
        ),
    ] = quantity("length", "width of the blob: a length, {spacings: n}, or {radius: r}")
    density: Positive | None = quantity(
        "density", "only where kinetic energy is wanted", default=None
    )

    @field_validator("epsilon", mode="after")
    @classmethod
    def _width(cls, epsilon: Any, info: ValidationInfo) -> Any:
        """Return a radius as the width of the blob that moves like it."""
        if not isinstance(epsilon, Radius):
            return epsilon
        return epsilon.radius * WIDTHS[info.data.get("blob", "algebraic7")]
