"""The case: what one file says about a scene, validated and immutable."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    PrivateAttr,
    Tag,
)

from rodsim.case.fields import (
    Count,
    Model,
    Name,
    Number,
    ParameterName,
    Positive,
    Vector,
    not_empty,
    number_tag,
    quantity,
)
from rodsim.case.fluid import Fluid, Spacings
from rodsim.case.initial import Initial
from rodsim.case.resolved import is_driven, resolved
from rodsim.case.rest import Rest
from rodsim.case.rod import Moduli, Rod
from rodsim.case.source import Source
from rodsim.case.time import Time
from rodsim.case.unit_names import Units
from rodsim.errors import Problem
from rodsim.registry import with_words

__all__ = ["Case", "Fluid", "Moduli", "Output", "Rest", "Rod", "Spacings", "Time", "Tube"]

DEFAULT_FRAMES = 100
FieldName = Literal["position", "director", "velocity", "angular_velocity", "force", "torque"]


class Tube(Model):
    """Passive markers on a tube around a rod."""

    kind: Literal["tube"]
    rod: Name = Field(description="the rod the tube is around")
    radius: Positive = quantity("length", "distance of the markers from the centreline")
    around: Count = Field(description="markers around the rod")
    along: Count = Field(description="markers along the rod")


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
    initial: Initial | None = Field(
        None, description="begin in a state of an earlier run: places of rods and bodies"
    )
    rest: Rest | None = Field(None, description="how `rodsim rest` looks for a state at rest")

    _source: Source = PrivateAttr(default_factory=Source)
    _warnings: tuple[Problem, ...] = PrivateAttr(())
    _device: str = PrivateAttr("cpu")

    @property
    def source(self) -> Source:
        """Path, text and overrides the case was read from, and the line of each key."""
        return self._source

    @property
    def warnings(self) -> tuple[Problem, ...]:
        """What looks wrong but does not stop a run."""
        return self._warnings

    @property
    def device(self) -> str:
        """Where its sums are computed: not of the file, but of who runs it."""
        return self._device

    def on(self, device: str) -> Case:
        """Return the same case, its sums computed on a device."""
        case = self.model_copy()
        case._device = device
        return case

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
    def folder(self) -> Path:
        """Where the names of files in it begin: beside the case file, or the current folder."""
        return Path(self.source.path).parent if self.source and self.source.path else Path()

    @property
    def files(self) -> list[str]:
        """The files it is read from: the case file, those of shapes, and of an earlier run."""
        if not (self.source and self.source.path):
            return []
        folder = os.path.dirname(self.source.path)
        found = [path for rod in self.rods.values() for path in rod.files]
        found += [self.initial.path] if self.initial else []
        return [self.source.path, *(os.path.join(folder, path) for path in found)]

    @property
    def max_step_size(self) -> float:
        """Longest step of rkc: over a drive that changes in time, it passes in small parts."""
        if self.time.max_step is not None:
            return self.time.max_step
        driven = is_driven(self) or any(rod.driven for rod in self.rods.values())
        return self.interval if driven else math.inf

    def resolved(self) -> dict[str, Any]:
        """Return the case as plain data with all defaults filled in, expressions as text.

        ``case_from_mapping`` makes the same case of it again. What another choice makes
        meaningless (the tolerance of euler and rk4) is left out.
        """
        return resolved(self)
