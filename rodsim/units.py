"""Units at the skin: names on values, and conversion to kT. Kernels see plain numbers."""

from rodsim.errors import UsageError

BOLTZMANN = 1.380649e-23  # J/K, exact
SI = {
    "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9, "Angstrom": 1e-10,
    "kg": 1.0, "g": 1e-3, "mg": 1e-6, "ug": 1e-9, "µg": 1e-9, "ng": 1e-12, "pg": 1e-15,
    "s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0,
}  # fmt: skip

LENGTHS = ("m", "cm", "mm", "um", "µm", "nm", "Angstrom")


def length_factor(unit: str, other: str) -> float | None:
    """Return how many ``other`` a length of 1 ``unit`` is, or None where one is not known."""
    unit, other = (name.replace("\N{GREEK SMALL LETTER MU}", "µ") for name in (unit, other))
    if unit == other:
        return 1.0
    if unit not in LENGTHS or other not in LENGTHS:
        return None
    return float(f"{SI[unit] / SI[other]:.12g}")


def unit_text(dimension, units: dict) -> str:
    """Return e.g. ``g um^2 s^-2`` for the exponents (1, 2, -2) of (mass, length, time).

    ``units`` names the unit of each of ``length``, ``mass``, ``time``; no dimension gives ``1``.
    """
    named = zip(("mass", "length", "time"), dimension, strict=True)
    parts = [units[kind] + (f"^{power}" if power != 1 else "") for kind, power in named if power]
    return " ".join(parts) or "1"


def thermal_energy(kelvin: float, units: dict) -> float:
    """Return k T in the unit of energy, mass length^2 time^-2, of a case.

    1 kT at 298 K is 4.114e-6 g um^2 s^-2. Raises UsageError for a unit that is not known.
    """
    try:
        length, mass, time = (SI[units[kind]] for kind in ("length", "mass", "time"))
    except KeyError as error:
        raise UsageError(f"kT: do not know the unit {error} (known: {', '.join(SI)})") from error
    return BOLTZMANN * kelvin / (mass * length**2 / time**2)
