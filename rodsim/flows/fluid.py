"""The fluid that the rods drive: free, or above a plane wall on which it does not slip.

The sums are in :mod:`rodsim.flows.free` and :mod:`rodsim.flows.wall`. A point of a rod at the wall
or below it makes all velocities NaN: a step that gets there is rejected.
"""

from __future__ import annotations

import numpy as np

from rodsim.case.fields import Model, Number, quantity
from rodsim.compiled.constants import GPU
from rodsim.compiled.parts import FLOW, TRACERS, Part
from rodsim.registry import Kind

CARD = "rodsim.flows.card.sums"


class Wall(Model):
    """A plane wall on which the fluid does not slip; the fluid is above it."""

    z: Number = quantity("length", "height of the wall")


def fluid_parts(scene) -> list[Part]:
    """Return the sums (32), (33) over the rods of a scene, and those at tracers."""
    rods, tracers = "planar" if scene.planar else "spatial", "flow"
    return [
        _part(scene, FLOW, "move_rods", rods),
        _part(scene, TRACERS, "move_tracers", tracers, pressure=pressure_of(scene)),
    ]


def _part(scene, side, kernel, which, **more):
    if scene.device == GPU:
        from rodsim.flows.card.sums import failed

        more["failed"] = failed
    height = -np.inf if scene.wall is None else scene.wall
    fixed = np.array([0.0, 0.0, scene.epsilon, scene.viscosity, height])
    sums = pair_sum(scene, which)
    return Part("fluid", side, f"rodsim.flows.parts:{kernel}", fixed=fixed, sums=sums, **more)


def pair_sum(scene, which: str) -> tuple[str, str]:
    """Return where a sum is and its runs of targets, whose addresses parts call it by.

    which : "spatial" and "planar" of u and w at rods, "flow" of u alone.
    """
    blob = scene.blob.removeprefix("algebraic")
    if scene.device == GPU:  # which has no use for the second
        return (f"{CARD}:{'' if scene.wall is None else 'wall_'}{which}_{blob}",) * 2
    home = "free" if scene.wall is None else "wall"
    return "rodsim.flows.by_threads:share_out", f"rodsim.flows.{home}:{which}_{blob}"


def pressure_of(scene):
    """Return what a part of the fluid has as its ``pressure``."""

    def pressure(points, sources, loads, t, left):
        """Return the pressure (T,) at points (3, T), eq. (62); NaN below a wall."""
        from rodsim.flows.blobs import BLOBS
        from rodsim.flows.by_threads import pressure_kernel

        at_wall, out = scene.wall is not None, np.zeros(points.shape[1])
        kernel = pressure_kernel(BLOBS[scene.blob], at_wall)
        kernel(points, sources, loads, scene.epsilon, scene.wall or 0.0, out)
        out[points[2] < scene.floor] = np.nan
        return out

    return pressure


KIND = Kind(
    build=lambda case, scene: fluid_parts(scene) if case.fluid.sums is None else [],
    word="wall",
    where="Fluid",
    words=Wall,
    about="a plane wall z = const. on which the fluid does not slip",
)
