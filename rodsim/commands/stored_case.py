"""What ``rodsim info`` says of the case in an output file: title, fluid, moduli, tolerance."""

from __future__ import annotations

from rodsim.case.expressions import Expression
from rodsim.case.methods import METHODS
from rodsim.commands.groups import VISCOSITY, in_water_units
from rodsim.errors import FileError
from rodsim.scene.build import epsilon_of
from rodsim.scene.restore import restore_case
from rodsim.units import unit_text

MOST_RODS = 50  # described one by one
FORCE = (1, 1, -2)


def describe_stored(run) -> list[str]:
    """Return lines on the case of an open run; those on its rods alone where it is damaged."""
    try:
        case = restore_case(run)
    except FileError:  # its frames can still be looked at
        return _rods(run, {})
    fluid, time, units = case.fluid, case.time, run.units
    epsilon = epsilon_of(case, run.rods)[0]
    spacings = f" = {epsilon / run.rods[0].spacing:.4g} spacings"
    option = METHODS[time.integrator].option
    moduli = {name: _moduli(rod.moduli, units) for name, rod in case.rods.items()}
    return [
        *([case.title] if case.title else []),
        f"fluid: viscosity {fluid.viscosity:.6g} {unit_text(VISCOSITY, units)}"
        f"{in_water_units(fluid.viscosity, units)}, {fluid.blob}, "
        f"epsilon {epsilon:.6g} {units['length']}{spacings}",
        *_rods(run, moduli),
        f"time: to {time.end:g} {units['time']} by {time.integrator}, "
        f"{option} {getattr(time, option):g}",
    ]


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
    named = {}
    for key, value in zip(moduli.keys, moduli.values, strict=True):
        text = value.text if isinstance(value, Expression) else f"{value:g}"
        named.setdefault(key, {})[text] = None
    bend, force = unit_text((1, 3, -2), units), unit_text(FORCE, units)
    words = {key: f"{key} {' and '.join(texts)}" for key, texts in named.items()}
    stiff = f"{words['bending']}, {words['twisting']} {bend}"
    return f"; {stiff}; {words['shear']}, {words['stretch']} {force}"
