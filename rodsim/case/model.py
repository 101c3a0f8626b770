"""The case: what one file says about a scene, validated and immutable."""

from __future__ import annotations

import math
import os
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    PrivateAttr,
    Tag,
    ValidationInfo,
    field_validator,
)

from rodsim.case.expressions import Expression
from rodsim.case.fields import (
    Count,
    Model,
    Modulus,
    ModulusOrPair,
    Name,
    Number,
    ParameterName,
    Positive,
    Vector,
    not_empty,
    number_tag,
    quantity,
    text_tag,
)
from rodsim.case.materials import WIDTHS, Material, Radius
from rodsim.case.methods import METHODS, Method
from rodsim.case.resolved import is_driven, resolved
from rodsim.case.shapes import Perturb, Shape
from rodsim.case.source import Source, child
from rodsim.case.strain import OWN, StrainEntry, StrainTable
from rodsim.case.unit_names import Units
from rodsim.errors import Problem
from rodsim.registry import with_words

DEFAULT_FRAMES = 100
FieldName = Literal["position", "director", "velocity", "angular_velocity", "force", "torque"]


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


class Moduli(Material):
    """Elastic moduli: numbers, or expressions in s at the middle of a segment.

    Bending and shear may differ along D1 and D2.
    """

    bending: ModulusOrPair = quantity("bending", "a1 = a2, or [a1, a2]")
    twisting: Modulus = quantity("bending", "a3")
    shear: ModulusOrPair = quantity("force", "b1 = b2, or [b1, b2]")
    stretch: Modulus = quantity("force", "b3")

    @property
    def values(self) -> tuple[float | Expression, ...]:
        """The moduli as (a1, a2, a3, b1, b2, b3)."""
        return (*_pair(self.bending), self.twisting, *_pair(self.shear), self.stretch)

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of the values."""
        return ("bending", "bending", "twisting", "shear", "shear", "stretch")

    @property
    def vary(self) -> bool:
        """Whether any of them is an expression."""
        return any(isinstance(value, Expression) for value in self.values)


def _pair(value):
    return value if isinstance(value, tuple) else (value, value)


@with_words
class Rod(Model):
    """One elastic rod."""

    like: Name | None = Field(
        None,
        description="another rod that says what is left out here: mappings are merged, lists and "
        "values replaced, null takes a key out",
    )
    repeat: Count | None = Field(
        None, description="make NAME_0, NAME_1, ...: so many, with the number as i in expressions"
    )
    parameters: dict[ParameterName, Number] = Field(
        {}, description="names for its expressions; they replace those of the case or add to them"
    )
    shape: Shape = Field(description="how it starts")
    moduli: Moduli = Field(description="elastic moduli")
    strain_twist: Annotated[
        Annotated[Literal["natural"], Tag("<text>")]
        | Annotated[tuple[StrainEntry, StrainEntry, StrainEntry], Tag("<list>")],
        Discriminator(text_tag),
    ] = quantity(
        "curvature",
        "natural: of the shape as built; or Omega_1, Omega_2, Omega_3: numbers, expressions in s, "
        "t, natural_1..3 and the parameters, or tables",
        default=(0.0, 0.0, 0.0),
    )
    perturb: Perturb | None = Field(
        None, description="disturbs the start, which symmetry may else keep from what is unstable"
    )

    @property
    def entries(self) -> tuple[float | Expression | StrainTable, ...]:
        """Omega_1, Omega_2, Omega_3."""
        return OWN if self.strain_twist == "natural" else self.strain_twist

    @property
    def driven(self) -> bool:
        """Whether its strain twist depends on time, or may: a table is not read yet."""
        return any(
            isinstance(entry, StrainTable) or (isinstance(entry, Expression) and entry.uses_t)
            for entry in self.entries
        )

    @property
    def uses_natural(self) -> bool:
        """Whether its strain twist depends on that of its shape."""
        return any(isinstance(entry, Expression) and entry.uses_natural for entry in self.entries)

    @property
    def files(self) -> list[str]:
        """The files of its shape and its tables, as the case names them."""
        shape = getattr(self.shape, "path", None)
        tables = [entry.table for entry in self.entries if isinstance(entry, StrainTable)]
        return [path for path in (shape, *tables) if path is not None]

    @property
    def needs_data(self) -> bool:
        """Whether its strain twist is known only once the rod is built or a table read."""
        return self.uses_natural or any(isinstance(entry, StrainTable) for entry in self.entries)


class Tube(Model):
    """Passive markers on a tube around a rod."""

    kind: Literal["tube"]
    rod: Name = Field(description="the rod the tube is around")
    radius: Positive = quantity("length", "distance of the markers from the centreline")
    around: Count = Field(description="markers around the rod")
    along: Count = Field(description="markers along the rod")


class Time(Model):
    """How long, and by which method."""

    end: Positive = quantity("time", "simulated time of the last frame; the first is at 0")
    integrator: Literal[tuple(METHODS)] = Field("rkc", description="rkc is adaptive")
    tolerance: float = Field(
        1e-4,
        strict=True,
        allow_inf_nan=False,
        ge=1e-13,
        lt=1.0,
        description="rkc: bound on the local error of a step, relative to the rod",
    )
    max_step: Positive | None = quantity(
        "time",
        "rkc: longest step, so that none passes over a short event; default: output.interval where "
        "a strain twist depends on t, else none",
        default=None,
    )
    step: Positive | None = quantity("time", "euler, rk4: the step", default=None)

    @property
    def method(self) -> Method:
        """What is known of the method."""
        return METHODS[self.integrator]


def _distinct_with_position(names: tuple[str, ...]) -> tuple[str, ...]:
    twice = {name for name in names if names.count(name) > 1}
    if twice:
        raise ValueError(f"{', '.join(sorted(twice))} given more than once")
    if "position" not in names:
        raise ValueError("must include position")
    return names


class Output(Model):
    """What is written, and how often."""

    interval: Positive | None = quantity(
        "time", f"simulated time between frames; default end/{DEFAULT_FRAMES}", default=None
    )
    fields: Annotated[tuple[FieldName, ...], AfterValidator(_distinct_with_position)] = Field(
        ("position", "director"), description="what each frame holds"
    )


TracerGroup = Annotated[
    Annotated[Tube, Tag("<mapping>")]
    | Annotated[tuple[Vector, ...], AfterValidator(not_empty), Tag("<list>")],
    Discriminator(number_tag),
]


@with_words
class Case(Model):
    """A validated case file.

    Lengths, masses and times are plain numbers in the case's own ``units``. ``warnings`` holds the
    Problems that do not stop a run; ``source`` says where each value came from.
    """

    title: str = Field("", description="shown in plots and tables")
    units: Units = Field(Units(), description="unit names, for labels and messages")
    parameters: dict[ParameterName, Number] = Field({}, description="names for expressions")
    fluid: Fluid = Field(description="the fluid")
    rods: dict[Name, Rod] = Field(min_length=1, description="the rods, by name")
    plane: Literal["yz"] | None = Field(None, description="yz: everything stays in one such plane")
    tracers: dict[Name, TracerGroup] = quantity(
        "length", "passive fluid markers: tubes around rods, or lists of points x, y, z", default={}
    )
    time: Time = Field(description="time and integrator")
    output: Output = Field(Output(), description="frames")

    _source: Source = PrivateAttr(default_factory=Source)
    _warnings: tuple[Problem, ...] = PrivateAttr(())

    @property
    def source(self) -> Source:
        """Path, text and overrides the case was read from, and the line of each key."""
        return self._source

    @property
    def warnings(self) -> tuple[Problem, ...]:
        """What looks wrong but does not stop a run."""
        return self._warnings

    @property
    def interval(self) -> float:
        """Simulated time between frames: by default end/100, for fixed steps in whole steps."""
        if self.output.interval is not None:
            return self.output.interval
        share = self.time.end / DEFAULT_FRAMES
        if self.time.method.adaptive or self.time.step is None:
            return share
        return max(1.0, float(np.ceil(share / self.time.step * (1.0 - 1e-9)))) * self.time.step

    @property
    def files(self) -> list[str]:
        """The files it is read from: the case file and those of shapes."""
        if not (self.source and self.source.path):
            return []
        folder = os.path.dirname(self.source.path)
        found = [path for rod in self.rods.values() for path in rod.files]
        return [self.source.path, *(os.path.join(folder, path) for path in found)]

    @property
    def max_step_size(self) -> float:
        """Longest step of rkc: over a drive that changes in time, it passes in small parts."""
        if self.time.max_step is not None:
            return self.time.max_step
        return self.interval if is_driven(self) else math.inf

    def resolved(self) -> dict[str, Any]:
        """Return the case as plain data with all defaults filled in, expressions as text.

        ``case_from_mapping`` makes the same case of it again. What another choice makes
        meaningless (the tolerance of euler and rk4) is left out.
        """
        return resolved(self)
