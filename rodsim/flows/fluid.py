"""The fluid that the rods drive, as a part of a scene; the sums are in :mod:`rodsim.flows.free`."""

import numpy as np

from rodsim.compiled.parts import FLOW, TRACERS, Part
from rodsim.registry import Kind


def fluid_parts(scene) -> list[Part]:
    """Return the sums (32), (33) over the rods of a scene, and those at tracers."""
    fixed = np.array([scene.epsilon, scene.viscosity])
    kind = "planar" if scene.planar else "spatial"
    name = f"rodsim.flows.free:{{}}_{scene.blob.removeprefix('algebraic')}".format
    return [
        Part("fluid", FLOW, name(kind), fixed=fixed),
        Part("fluid", TRACERS, name("tracers"), fixed=fixed, pressure=_pressure(scene)),
    ]


def _pressure(scene):
    def pressure(points, sources, loads, t):
        """Return the pressure (T,) at points (3, T), eq. (62)."""
        from rodsim.flows.blobs import BLOBS
        from rodsim.flows.free import pressure_kernel

        out = np.empty(points.shape[1])
        pressure_kernel(BLOBS[scene.blob])(points, sources, loads, scene.epsilon, out)
        return out

    return pressure


KIND = Kind(build=lambda case, scene: fluid_parts(scene))
