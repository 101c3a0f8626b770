"""The word ``sums``: how exact the sums over all points are to be.

With ``fluid: {sums: {accuracy: a}}`` the velocities are good to a relative error a, root mean
square over the points, at a cost that grows about as their number; without it they are exact, at
one that grows as its square.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from pydantic import Field

from rodsim.case.fields import Model
from rodsim.compiled.parts import FLOW, TRACERS, Part
from rodsim.errors import CaseError
from rodsim.flows.fluid import pressure_of
from rodsim.registry import Kind

HOME = "rodsim.flows.fast.sums"
EXACT = "rodsim.flows.free"
SHARE = 0.1  # of the tolerance: what the sums may add to the error of a step
PURE = (0, 0, 0)  # the dimension of a ratio
ERRORS = ("sum_error", (2,), PURE)
TRACER_ERRORS = ("tracer_sum_error", (), PURE)


UNKNOWN = (float("nan"),) * 2


class Sums(Model):
    """The sums over all points by arcs and their proxies, in place of the exact ones."""

    accuracy: Annotated[
        float,
        Field(
            strict=True,
            allow_inf_nan=False,
            ge=1e-12,
            le=0.1,
            description="relative error of the velocities, root mean square over the points; it "
            "is measured at every step",
        ),
    ]


def _build(case, scene) -> list[Part]:
    if case.fluid.sums is None:
        return []
    if scene.nodes > scene.rods.points:
        reason = "there is no fast sum with bodies and wound hooks: leave out sums"
        raise CaseError([case.source.problem(("fluid", "sums"), reason)])
    blob = scene.blob.removeprefix("algebraic")
    kind = "planar" if scene.planar else "spatial"
    rods, tracers = _Rods(scene, case.fluid.sums), _Tracers(scene, case.fluid.sums)
    return [
        Part(
            "fluid", FLOW, f"{HOME}:{kind}_{blob}", prepare=rods.prepare,
            needs=(f"{EXACT}:{kind}_{blob}",), observe=rods.observe, series=(ERRORS,),
        ),
        Part(
            "fluid", TRACERS, f"{HOME}:tracers_{blob}", prepare=tracers.prepare,
            needs=(f"{EXACT}:tracers_{blob}",), pressure=pressure_of(scene, EXACT),
            **({"observe": tracers.observe, "series": (TRACER_ERRORS,)} if tracers.any else {}),
        ),
    ]  # fmt: skip


class _Rods:
    """The fast sum of a scene's rods, made when it is first wanted."""

    def __init__(self, scene, sums):
        self._about = scene.rods.count, sums.accuracy, scene.epsilon, scene.viscosity, scene.blob
        self._planar, self.sum = scene.planar, None

    def prepare(self, state, loads):
        """Return the tables of the sum for a step from a state."""
        if self.sum is None:
            from rodsim.flows.fast.plan import RodSum

            self.sum = RodSum(*self._about, self._planar)
        return self.sum.prepare(state.position, loads)

    def observe(self, state, row, scene):
        """Return the errors of u and w that the tables were made with."""
        return {ERRORS[0]: UNKNOWN if self.sum is None else self.sum.error}


class _Tracers:
    """The same of its tracers, and of any other targets."""

    def __init__(self, scene, sums):
        self._about = scene.rods.count, sums.accuracy, scene.epsilon, scene.viscosity, scene.blob
        self.any, self.sum = scene.initial.tracer.size > 0, None

    def prepare(self, state, loads):
        """Return the tables of the sum for a step from a state."""
        if self.sum is None:
            from rodsim.flows.fast.plan import GroupSum

            self.sum = GroupSum(*self._about)
        return self.sum.prepare(state.tracer, state.position, loads)

    def observe(self, state, row, scene):
        """Return the error of u that the tables were made with."""
        return {TRACER_ERRORS[0]: (UNKNOWN if self.sum is None else self.sum.error)[0]}


def _check(case, rod_names) -> Iterator[tuple]:
    fluid = case.fluid
    if fluid is not None and fluid.sums is not None and fluid.wall is not None:
        yield ("fluid", "sums"), "there is no fast sum beside a wall: leave out sums, or wall"


def _doubt(case) -> Iterator[tuple]:
    if case.fluid is None or case.fluid.sums is None or case.time is None:
        return
    accuracy, time = case.fluid.sums.accuracy, case.time
    if time.method.adaptive and accuracy > SHARE * time.tolerance * (1.0 + 1e-9):
        advice = f"use {SHARE * time.tolerance:.1g} or less"
        yield (
            ("fluid", "sums", "accuracy"),
            f"is more than a tenth of time.tolerance = {time.tolerance:g}, and may be what limits "
            f"the run: {advice}",
        )


KIND = Kind(
    build=_build,
    word="sums",
    where="Fluid",
    words=Sums,
    about="sums over all points that are fast and have a relative error, for thousands of points",
    check=_check,
    doubt=_doubt,
)
