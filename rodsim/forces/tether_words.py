"""Words of the case file for tethers, and for the places that they hold."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, create_model

from rodsim.case.fields import Model, Name, NotNegative, Positive, Vector, number_tag, quantity
from rodsim.forces.places import AT, S, at_field, s_field

CENTRE = (0.0, 0.0, 0.0)


class OnRod(Model):
    """A place on a rod."""

    rod: Name = Field(description="the rod")
    at: AT = at_field()
    s: S = s_field()


class OnBody(Model):
    """A place on a body, or in it."""

    body: Name = Field(description="the body")
    at: Vector = quantity(
        "length", "x, y, z in its own frame: about its centre, the axis along z", default=CENTRE
    )


def _end_tag(value: Any) -> str | None:
    tag = number_tag(value)
    on_body = "body" in value if isinstance(value, dict) else isinstance(value, OnBody)
    return "<body>" if on_body else tag


End = Annotated[
    Annotated[OnRod, Tag("<mapping>")]
    | Annotated[OnBody, Tag("<body>")]
    | Annotated[Vector, Tag("<list>")],
    Discriminator(_end_tag),
]


class _Tether(Model):
    """A spring between two places."""

    stiffness: Positive = quantity("stiffness", "k: force per change of length")
    length: NotNegative = quantity("length", "l: length at rest", default=0.0)
    only: Literal["pull", "push"] | None = Field(
        None, description="pull: a rope, slack where it is shorter; push: a strut"
    )


Tether = create_model(  # `from` is a word of Python's, and cannot be written as a field
    "Tether",
    __base__=_Tether,
    __module__=__name__,
    __doc__=_Tether.__doc__,
    **{
        "from": (
            End,
            quantity("length", "one end: a place on a rod or a body, or a point x, y, z"),
        ),
        "to": (End, quantity("length", "the other end")),
    },
)
