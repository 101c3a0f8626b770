"""What blocks are to those who look for states at rest."""

from __future__ import annotations

import numpy as np

from rodsim.blocks import fields as f
from rodsim.compiled.parts import FORCE, Part, Statics


def statics_of(blocks, scene, shared) -> Statics:
    """Return the degrees of freedom c N + k that something holds, and what free bodies carry.

    Held are the places of ends, of clamped ones the turns, and fixed bodies. ``shared`` : the row
    and the numbers of the blocks, which hooks as forces have too.
    """
    if reason := _no_rest(blocks):
        return Statics(refused=reason)
    n, held, carried = scene.nodes, [], []
    for block in blocks:
        if not block.free and block.node >= 0:
            held += [c * n + block.node for c in range(6)]
        for member in block.members:
            clamped = member.joint.kind == f.CLAMPED
            held += [c * n + member.node for c in range(6 if clamped else 3)]
            if block.free:
                carried.append((block.node, member.node, clamped))
    return Statics(holds=tuple(held), carries=tuple(carried), adds=_hooks(blocks, shared))


def _no_rest(blocks) -> str:
    """Return why states at rest cannot be looked for, or nothing."""
    for block in blocks:
        if block.node >= 0 and block.motion >= 0:
            return f"body '{block.name}' has a given motion: at rest it is free or fixed"
        for member in block.members:
            if member.joint.motor != f.STILL:
                return f"the motor of {member.name} drives for ever: leave it out"
            if member.joint.kind == f.HOOKED and member.joint.twisting == 0.0:
                return (
                    f"the hook of {member.name} is stiff in twist, which holds how it turns and "
                    "not where it is: give twisting a number"
                )
    return ""


def _hooks(blocks, shared) -> tuple[Part, ...]:
    """Return the part of all hooks, if there are any."""
    members = [member for block in blocks for member in block.members]
    hooks = [q for q, member in enumerate(members) if member.joint.kind == f.HOOKED]
    if not hooks:
        return ()

    def observe(state, row, scene):
        from rodsim.blocks.springs import spring_energies

        energies = np.zeros(len(members))
        spring_energies(row(state.time), shared["fixed"], state.geometry, energies)
        return {"hook_energy": energies[hooks]}

    kernel = "rodsim.blocks.springs:apply_springs"
    return (Part("hooks", FORCE, kernel, **shared, observe=observe),)
