"""The section ``initial`` of a case: a scene that begins in a state of an earlier run."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from rodsim.case.fields import Model


class Initial(Model):
    """The state to begin with: places of rods and bodies in an output, in place of the shapes.

    The shapes still say what the scene is made of: what is natural to a rod, where ends are held
    and ``move`` counts from, how a rod sits on a body, a hook that bears no load. Time starts at 0,
    and what depends on it with it: to go on with a run, ``resume`` it. ``perturb`` disturbs the
    shapes, not this state.
    """

    path: str = Field(min_length=1, description="an output of rodsim")
    frame: Annotated[int, Field(strict=True)] = Field(
        -1, description="which of its frames, from the end if negative"
    )
