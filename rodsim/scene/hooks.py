"""Hooks that are stiffer than the rods behind them."""

from __future__ import annotations

from rodsim.blocks.ends import end_node, held_ends
from rodsim.forces.places import rod_named


def stiff_hooks(case, scene) -> list:
    """Return a warning for each hook stiffer than the first segment of its rod, a/ds.

    Softer ones leave the fastest rate of a scene as it is.
    """
    problems = []
    for name, which, end in held_ends(case):
        if end.hook is None:
            continue
        rod = rod_named(scene.rods, name)
        bending, twisting = _segment(scene, rod, end_node(rod, which), which)
        for key, limit in (("bending", bending), ("twisting", twisting)):
            value = getattr(end.hook, key)
            if value != "stiff" and value > limit:
                reason = (
                    f"is stiffer than the rod's own segment there, a/ds = {limit:.3g}: it raises "
                    "the fastest rate; without a hook the joint is stiff and does not"
                )
                path = ("rods", name, which, "hook", key)
                problems.append(case.source.problem(path, reason))
    return problems


def _segment(scene, rod, node, which):
    """Return a/ds of bending and twisting of the segment at an end."""
    moduli = rod.moduli
    if scene.along is not None:
        moduli = scene.along[:6, node if which == "start" else node - 1]
    return min(moduli[0], moduli[1]) / rod.spacing, moduli[2] / rod.spacing
