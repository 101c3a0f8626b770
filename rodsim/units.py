"""Units at the skin: names on values, and conversion to SI. Kernels see plain numbers."""

from rodsim.errors import UsageError

BOLTZMANN = 1.380649e-23  # J/K, exact
VISCOSITY = (1, -1, -1)  # its exponents of mass, length, time
_PREFIXES = {
    "k": 1e3, "": 1.0, "c": 1e-2, "m": 1e-3, "u": 1e-6, "\u00b5": 1e-6, "\u03bc": 1e-6, "n": 1e-9,
    "p": 1e-12, "f": 1e-15, "a": 1e-18,
}  # fmt: skip


def _scaled(unit, prefixes, size=1.0):
    return {prefix + unit: _PREFIXES[prefix] * size for prefix in ("", *prefixes)}


_SMALL = ("m", "u", "\u00b5", "\u03bc", "n", "p", "f")
SI = {  # of each kind: the names that are known, and their size in m, kg, s, N
    "length": {
        **_scaled("m", ("c", *_SMALL)),
        **dict.fromkeys(("\u00c5", "\u212b", "A", "Angstrom", "angstrom"), 1e-10),
    },
    "mass": {**_scaled("g", ("k", *_SMALL, "a"), 1e-3), "Da": 1.66053906892e-27},
    "time": {**_scaled("s", _SMALL), "min": 60.0, "h": 3600.0},
    "force": {**_scaled("N", _SMALL), "dyn": 1e-5},
}


def length_factor(unit: str, other: str) -> float | None:
    """Return how many ``other`` a length of 1 ``unit`` is, or None where one is not known."""
    lengths = SI["length"]
    if unit == other:
        return 1.0
    if unit not in lengths or other not in lengths:
        return None
    return float(f"{lengths[unit] / lengths[other]:.12g}")


def mass_name(units: dict) -> str:
    """Return the name of the unit of mass; where force is named instead, force length^-1 time^2."""
    if units.get("force"):
        return f"{units['force']} {units['length']}^-1 {units['time']}^2"
    return units["mass"]


def unit_text(dimension, units: dict) -> str:
    """Return e.g. ``g um^2 s^-2`` for the exponents (1, 2, -2) of (mass, length, time).

    ``units`` names the unit of ``length``, ``time`` and of ``mass`` or ``force``; the mass may be a
    product such as ``pN um^-1 s^2``. No dimension gives ``1``.
    """
    names = (mass_name(units), units["length"], units["time"])
    powers: dict[str, int] = {}
    for name, power in zip(names, dimension, strict=True):
        for factor in name.split():
            word, _, own = factor.partition("^")
            powers[word] = powers.get(word, 0) + power * int(own or 1)
    parts = [word + (f"^{power}" if power != 1 else "") for word, power in powers.items() if power]
    return " ".join(parts) or "1"


def in_si(dimension, units: dict) -> float:
    """Return what 1 in a unit of these exponents of (mass, length, time) is in SI units.

    Raises KeyError for a name that is not known.
    """
    length, time = SI["length"][units["length"]], SI["time"][units["time"]]
    name, *product = mass_name(units).split()
    mass = SI["force"][name] / length * time**2 if product else SI["mass"][name]
    return mass ** dimension[0] * length ** dimension[1] * time ** dimension[2]


def in_water_units(viscosity: float, units: dict) -> str:
    """Return `` (1 mPa s)`` for a viscosity in a case's units, nothing where they are not known."""
    try:
        return f" ({1e3 * viscosity * in_si(VISCOSITY, units):.4g} mPa s)"
    except KeyError:
        return ""


def thermal_energy(kelvin: float, units: dict) -> float:
    """Return k T in the unit of energy, mass length^2 time^-2, of a case.

    1 kT at 298 K is 4.114e-6 g um^2 s^-2. Raises UsageError for a unit that is not known.
    """
    try:
        return BOLTZMANN * kelvin / in_si((1, 2, -2), units)
    except KeyError as error:
        known = ", ".join(name for kind in SI.values() for name in kind)
        raise UsageError(f"kT: do not know the unit {error} (known: {known})") from error
