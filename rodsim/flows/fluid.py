"""The fluid that the rods drive: free, or above a plane wall on which it does not slip.

The sums are in :mod:`rodsim.flows.free` and :mod:`rodsim.flows.wall`. A point of a rod at the wall
or below it makes all velocities NaN: a step that gets there is rejected.
"""

from __future__ import annotations

from importlib import import_module

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
    home, kind = _home(scene), "planar" if scene.planar else "spatial"
    pressure = pressure_of(scene, home)
    if scene.device == GPU:
        from rodsim.flows.card.sums import parts_on_card

        return parts_on_card(scene, kind, pressure)
    fixed = np.array(
        [scene.epsilon, scene.viscosity, *([] if scene.wall is None else [scene.wall])]
    )
    blob = scene.blob.removeprefix("algebraic")
    return [
        Part("fluid", FLOW, f"{home}:{kind}_{blob}", fixed=fixed),
        Part("fluid", TRACERS, f"{home}:tracers_{blob}", fixed=fixed, pressure=pressure),
    ]


def pair_sums(scene) -> tuple[str, str]:
    """Return where the sums are that parts call by address: of u and w, of u alone."""
    blob = scene.blob.removeprefix("algebraic")
    if scene.device == GPU:
        at = "" if scene.wall is None else "wall_"
        return tuple(f"{CARD}:{at}{which}_{blob}" for which in ("spatial", "flow"))
    return tuple(f"{_home(scene)}:{which}_{blob}" for which in ("sum", "sum_u"))


def _home(scene):
    return f"rodsim.flows.{'free' if scene.wall is None else 'wall'}"


def pressure_of(scene, home):
    """Return what a part of the fluid has as its ``pressure``."""

    def pressure(points, sources, loads, t, left):
        """Return the pressure (T,) at points (3, T), eq. (62); NaN below a wall."""
        from rodsim.flows.blobs import BLOBS

        height = () if scene.wall is None else (scene.wall,)
        out = np.zeros(points.shape[1])
        kernel = import_module(home).pressure_kernel(BLOBS[scene.blob])
        kernel(points, sources, loads, scene.epsilon, *height, out)
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
