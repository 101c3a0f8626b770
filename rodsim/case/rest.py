"""The section ``rest`` of a case: how ``rodsim rest`` looks for a state at rest."""

from __future__ import annotations

from pydantic import Field

from rodsim.case.fields import Count, Model, Positive, quantity


class Rest(Model):
    """How the state at rest is found; only ``rodsim rest`` and ``rodsim stability`` read it."""

    tolerance: Positive = Field(
        1e-9,
        description="largest load at rest: force in units of bending modulus/length^2 plus torque "
        "in bending modulus/length; never below what rounding leaves",
    )
    max_step: Positive | None = quantity(
        "length", "how far a point may go in one step; default length/50", default=None
    )
    steps: Count = Field(2000, description="steps after which it is given up")
