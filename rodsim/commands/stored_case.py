"""What ``rodsim info`` says of the case in an output file: title, fluid, moduli, tolerance.

The text of a resolved case is whole, with all defaults in it, and is read as it is. The models of
a case take longer to load than all else here; only a run with contact or a drive asks them.
"""

from __future__ import annotations

import re

from rodsim.case.methods import METHODS
from rodsim.errors import FileError
from rodsim.scene.neighbours import hydrodynamic_diameter
from rodsim.text import texts_in
from rodsim.units import VISCOSITY, in_water_units, unit_text

MOST_RODS = 50  # described one by one
BENDING, FORCE = (1, 3, -2), (1, 1, -2)
DAMAGE = FileError, ValueError, TypeError, KeyError, AttributeError, RecursionError
_TIME = re.compile(r"\bt\b")


def describe_stored(run) -> list[str]:
    """Return lines on the case of an open run; those on its rods alone where it is damaged."""
    try:
        return _described(run, run.case_data())
    except DAMAGE:  # its frames can still be looked at
        return _rods(run, {})


def _described(run, case):
    fluid, time, units = case["fluid"], case["time"], run.units
    viscosity, epsilon = fluid["viscosity"], epsilon_of(run, case)
    spacings = f" = {epsilon / run.rods[0].spacing:.4g} spacings"
    option = METHODS[time["integrator"]].option
    moduli = {rod.name: _moduli(case["rods"][rod.name]["moduli"], units) for rod in run.rods}
    return [
        *([case["title"]] if case["title"] else []),
        f"fluid: viscosity {viscosity:.6g} {unit_text(VISCOSITY, units)}"
        f"{in_water_units(viscosity, units)}, {fluid['blob']}, "
        f"epsilon {epsilon:.6g} {units['length']}{spacings}",
        *_rods(run, moduli),
        f"time: to {time['end']:g} {units['time']} by {time['integrator']}, "
        f"{option} {time[option]:g}",
    ]


def epsilon_of(run, case: dict) -> float:
    """Return the width of the blobs of a stored run as a length."""
    epsilon = case["fluid"]["epsilon"]
    if isinstance(epsilon, dict):
        return float(epsilon["spacings"] * run.rods[0].spacing)
    return float(epsilon)


def diameter_of(run, case: dict) -> float:
    """Return how thick the rods of a stored run are: to each other, or else to the fluid."""
    if case.get("contact") is None:
        return hydrodynamic_diameter(case["fluid"]["blob"], epsilon_of(run, case))
    from rodsim.scene.restore import restore_case, stored_diameter

    return stored_diameter(run, restore_case(run))


def is_driven(run, case: dict) -> bool:
    """Tell whether anything in the case of a stored run depends on time."""
    kept = {key: item for key, item in case.items() if key not in ("title", "units")}
    if not any(map(_TIME.search, texts_in(kept))):
        return False
    from rodsim.case.resolved import is_driven
    from rodsim.scene.restore import restore_case

    return is_driven(restore_case(run))  # it may be the name of a rod


def _rods(run, moduli):
    lines = []
    for rod in run.rods[:MOST_RODS]:
        kind = "closed" if rod.closed else "open"
        what = f"{rod.count} points, {kind}, spacing {rod.spacing:g} {run.units['length']}"
        lines.append(f"rod {rod.name}: {what}{moduli.get(rod.name, '')}")
    if len(run.rods) > MOST_RODS:
        lines.append(f"and {len(run.rods) - MOST_RODS} more rods")
    return lines


def _moduli(moduli, units):
    """Return the moduli of a rod in words, those that are equal once."""
    words = {}
    for key in ("bending", "twisting", "shear", "stretch"):
        given = moduli[key] if isinstance(moduli[key], list) else [moduli[key]]
        texts = [value if isinstance(value, str) else f"{value:g}" for value in given]
        words[key] = f"{key} {' and '.join(dict.fromkeys(texts))}"
    bend, force = unit_text(BENDING, units), unit_text(FORCE, units)
    stiff = f"{words['bending']}, {words['twisting']} {bend}"
    return f"; {stiff}; {words['shear']}, {words['stretch']} {force}"
