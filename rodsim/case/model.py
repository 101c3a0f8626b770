"""The case: what one file says about a scene, validated and immutable."""

from __future__ import annotations

import math
import os
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, Discriminator, Field, PrivateAttr, Tag

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
    UnitName,
    Vector,
    not_empty,
    number_tag,
    quantity,
    text_tag,
)
from rodsim.case.shapes import Shape
from rodsim.case.source import Source
from rodsim.case.strain import OWN, StrainEntry, StrainTable
from rodsim.errors import Problem

DEFAULT_FRAMES = 100
FieldName = Literal["position", "director", "velocity", "angular_velocity", "force", "torque"]


class Units(Model):
    """Names of the units; the computation uses the plain numbers."""

    length: UnitName = Field("um", description="unit of length")
    mass: UnitName = Field("g", description="unit of mass")
    time: UnitName = Field("s", description="unit of time")


class Spacings(Model):
    """A length in units of the rods' common spacing."""

    spacings: Positive = Field(description="epsilon / ds")


class Fluid(Model):
    """The fluid and the blob that spreads each point's load."""

    viscosity: Positive = quantity("viscosity", "dynamic viscosity")
    blob: Literal["algebraic7", "algebraic9"] = Field("algebraic7", description="eq. 12 or eq. 13")
    epsilon: Annotated[
        Annotated[Positive, Tag("<number>")] | Annotated[Spacings, Tag("<mapping>")],
        Discriminator(number_tag),
    ] = quantity("length", "width of the blob: a length, or {spacings: n}")
    density: Positive | None = quantity(
        "density", "only where kinetic energy is wanted", default=None
    )


class Moduli(Model):
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


class Rod(Model):
    """One elastic rod."""

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
    integrator: Literal["rkc", "rk4", "euler"] = Field("rkc", description="rkc is adaptive")
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
        if self.time.integrator == "rkc" or self.time.step is None:
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
    def longest_step(self) -> float:
        """Longest step of rkc: over a drive that changes in time, it passes in small parts."""
        if self.time.max_step is not None:
            return self.time.max_step
        return self.interval if any(rod.driven for rod in self.rods.values()) else math.inf

    def problem(self, key_path: str | tuple, reason: str) -> Problem:
        """Return a Problem at a key, with its file:line, value and unit, for later checks."""
        return self._source.problem(key_path, reason)

    def resolved(self) -> dict[str, Any]:
        """Return the case as plain data with all defaults filled in, expressions as text.

        ``case_from_mapping`` makes the same case of it again. What another choice makes
        meaningless (the tolerance of euler and rk4) is left out.
        """
        data = _plain(self)
        data["output"]["interval"] = self.interval
        if self.time.integrator != "rkc":
            del data["time"]["tolerance"]
        return data


def _plain(value: Any) -> Any:
    """Return a model as dicts, lists and scalars; what is None is left out."""
    if isinstance(value, BaseModel):
        value = {name: getattr(value, name) for name in type(value).model_fields}
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items() if item is not None}
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return value.text if isinstance(value, Expression) else value
