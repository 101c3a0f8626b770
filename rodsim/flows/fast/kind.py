"""The word ``sums``: how exact the sums over all points are to be.

With ``fluid: {sums: {accuracy: a}}`` the velocities are good to a relative error a, root mean
square over the points, at a cost that grows about as their number; without it they are exact, at
one that grows as its square.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

import numpy as np
from pydantic import Field

from rodsim.blocks.ends import end_node, held_ends
from rodsim.case.fields import Model
from rodsim.compiled.kernels import address_of
from rodsim.compiled.parts import FLOW, TRACERS, Part
from rodsim.flows.fluid import pair_sum, pressure_of
from rodsim.forces.places import rod_named
from rodsim.registry import Kind

HOME = "rodsim.flows.fast.parts"
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
    at, blob = "" if scene.wall is None else "wall_", scene.blob.removeprefix("algebraic")
    kind = "planar" if scene.planar else "spatial"
    held = [end_node(rod_named(scene.rods, rod), which) for rod, which, _ in held_ends(case)]
    exact = pair_sum(scene, "spatial")
    needs = *pair_sum(scene, kind), *(exact if held else ())
    rods = _Rods(scene, case.fluid.sums, held, exact)
    tracers = _Tracers(scene, case.fluid.sums)
    return [
        Part(
            "fluid", FLOW, f"{HOME}:{at}{kind}_{blob}", prepare=rods.prepare,
            needs=needs, observe=rods.observe, series=(ERRORS,),
        ),
        Part(
            "fluid", TRACERS, f"{HOME}:{at}tracers_{blob}", prepare=tracers.prepare,
            needs=pair_sum(scene, "flow"), pressure=pressure_of(scene),
            **({"observe": tracers.observe, "series": (TRACER_ERRORS,)} if tracers.any else {}),
        ),
    ]  # fmt: skip


class _Rods:
    """The fast sum of a scene's rods, made when it is first wanted."""

    def __init__(self, scene, sums, held, exact):
        self._about = scene.rods.count, sums.accuracy, scene.epsilon, scene.viscosity, scene.blob
        self._options, self.sum = (scene.planar, scene.wall), None
        self._held, self._exact = held, exact
        self._start = scene.initial.position  # by which the number of proxies is chosen

    def prepare(self, state, loads):
        """Return the tables of the sum for a step from a state."""
        if self.sum is None:
            from rodsim.flows.fast.plan import rod_sum

            self.sum = rod_sum(self._start, *self._about, *self._options)
            if self._held:
                self.sum.held, self.sum.sum = self._held, tuple(map(address_of, self._exact))
        return self.sum.prepare(*_of_rods(self.sum, state.position, loads))

    def observe(self, state, row, scene):
        """Return the errors of u and w that the tables were made with."""
        return {ERRORS[0]: UNKNOWN if self.sum is None else self.sum.error}


class _Tracers:
    """The same of its tracers, and of any other targets."""

    def __init__(self, scene, sums):
        self._about = scene.rods.count, sums.accuracy, scene.epsilon, scene.viscosity, scene.blob
        self.any, self.sum = scene.initial.tracer.size > 0, None
        self._wall = scene.wall

    def prepare(self, state, loads):
        """Return the tables of the sum for a step from a state."""
        if self.sum is None:
            from rodsim.flows.fast.plan import GroupSum

            self.sum = GroupSum(*self._about, wall_height=self._wall)
        return self.sum.prepare(state.tracer, *_of_rods(self.sum, state.position, loads))

    def observe(self, state, row, scene):
        """Return the error of u that the tables were made with."""
        return {TRACER_ERRORS[0]: (UNKNOWN if self.sum is None else self.sum.error)[0]}


def _of_rods(fast, *arrays):
    """Return the columns of the points of rods, which come first among the nodes."""
    return [np.ascontiguousarray(array[:, : fast.arcs.points]) for array in arrays]


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
    doubt=_doubt,
)
