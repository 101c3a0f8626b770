"""The section ``time`` of a case: how long, and by which method."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from rodsim.case.fields import Model, Positive, quantity
from rodsim.case.methods import METHODS, Method


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
        description="rkc: bound on the local error of a step, of each rod relative to its length, "
        "and of the tracers",
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
