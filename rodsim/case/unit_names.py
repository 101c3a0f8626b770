"""The names of a case's units."""

from __future__ import annotations

from pydantic import Field, model_validator

from rodsim.case.fields import Model, UnitName
from rodsim.units import mass_name


class Units(Model):
    """Names of the units; the computation uses the plain numbers. ``force`` may replace mass."""

    length: UnitName = Field("um", description="unit of length")
    mass: UnitName = Field("g", description="unit of mass")
    time: UnitName = Field("s", description="unit of time")
    force: UnitName | None = Field(None, description="unit of force, in place of that of mass")

    @model_validator(mode="after")
    def _mass_or_force(self):
        if self.force is not None and "mass" in self.model_fields_set:
            raise ValueError("give mass or force, not both: each follows from the other")
        return self

    @property
    def names(self) -> dict[str, str]:
        """Names of the units of length, mass and time; of mass it may be that of a product."""
        return {**self.model_dump(include={"length", "time"}), "mass": mass_name(self.model_dump())}
