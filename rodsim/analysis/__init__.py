"""Functions of the arrays of a run: each loads what it needs on first use.

>>> import rodsim
>>> with rodsim.open_trajectory("out.h5") as run:
...     rodsim.analysis.writhe(run["ring"].position[-1])

Every quantity of ``rodsim measure`` is one of them: those of geometry and motion take arrays; those
that the run has stored (power, gap, energies) take the run, or one rod of it.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # the same names, for type checkers and editors
    from rodsim.analysis.curve import *  # noqa: F403
    from rodsim.analysis.difference import *  # noqa: F403
    from rodsim.analysis.energy import *  # noqa: F403
    from rodsim.analysis.helix import *  # noqa: F403
    from rodsim.analysis.measuring import *  # noqa: F403
    from rodsim.analysis.strain import *  # noqa: F403
    from rodsim.analysis.swimming import *  # noqa: F403
    from rodsim.analysis.topology import *  # noqa: F403

_HOMES = {
    "curve": (
        "amplitude", "curvature", "end_to_end", "length", "misalignment", "radius_of_gyration",
        "stretch", "torsion",
    ),
    "difference": ("position_errors", "triad_angle"),
    "energy": ("energy_table",),
    "helix": ("fit_helix", "pitch", "radius", "triad_turns", "turns"),
    "measuring": ("measure",),
    "strain": ("bend", "strain_twist"),
    "swimming": ("efficiency", "speed", "swimming_velocity", "towing_drag", "velocity"),
    "topology": ("link", "linking_number", "twist", "writhe"),
}  # fmt: skip
_FUNCTIONS = {name: module for module, names in _HOMES.items() for name in names}


def __getattr__(name):
    if name in _FUNCTIONS:
        return getattr(import_module(f"rodsim.analysis.{_FUNCTIONS[name]}"), name)
    if not name.startswith("_"):
        from rodsim.analysis.measures import MEASURES

        if name in MEASURES:  # of what is stored
            return lambda run: run.measure(name)
    raise AttributeError(f"module 'rodsim.analysis' has no attribute {name!r}")


def __dir__():
    from rodsim.analysis.measures import MEASURES

    return sorted({*_FUNCTIONS, *MEASURES})
