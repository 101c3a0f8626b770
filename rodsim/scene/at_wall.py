"""What a plane wall asks of a scene: all of it lies above. How far above: the mirrored gap."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rodsim.errors import Problem
from rodsim.scene.neighbours import DIAMETERS


def below_wall(case, scene) -> Iterator[Problem]:
    """Yield a problem for each rod, and for the tracers, that are not above the wall."""
    if scene.wall is None:
        return
    z = scene.initial.position[2]
    for rod in scene.rods:
        k = int(np.argmin(z[rod.nodes]))
        lowest = z[rod.first + k]
        if lowest <= scene.wall:
            reason = f"is at z = {lowest:.6g}: must be above the wall, z = {scene.wall:g}"
            if case.initial is None:
                yield case.source.problem(("rods", rod.name, "shape"), f"point {k} {reason}")
            else:
                whose = f"point {k} of rod '{rod.name}'"
                yield case.source.problem(("initial", "path"), f"{whose} {reason}")
    tracer = scene.initial.tracer[2]
    if (tracer < scene.floor).any():
        reason = f"one is at z = {tracer.min():.6g}, below the wall, z = {scene.wall:g}"
        yield case.source.problem(("tracers",), reason)


def near_wall(case, scene) -> Iterator[Problem]:
    """Yield a warning for each rod that starts closer to the wall than epsilon."""
    if scene.wall is None:
        return
    height = scene.initial.position[2] - scene.wall
    for rod in scene.rods:
        k = int(np.argmin(height[rod.nodes]))
        lowest = height[rod.first + k]
        if lowest < scene.epsilon:
            reason = (
                f"point {k} is {lowest:.4g} above the wall, closer than epsilon = "
                f"{scene.epsilon:.4g}: the radius of a rod is about "
                f"{0.5 * DIAMETERS[scene.blob]:.2g} epsilon, and lubrication is not resolved"
            )
            yield case.source.problem(("rods", rod.name, "shape"), reason)


def mirror_gap(scene, position) -> tuple[float, str, int]:
    """Return the smallest distance of a point (3, N) and its mirror image, 2 (z - h), whose it is.

    With it the rod's name and the number of the point on it. Negative below the wall.
    """
    lowest = int(np.argmin(position[2, : scene.rods.points]))
    return 2.0 * float(position[2, lowest] - scene.wall), *scene.rods.locate(lowest)
