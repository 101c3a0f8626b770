"""How keys and values look in a message, and the 'did you mean' of every message."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from rodsim.text import printable

# What other programs and papers call it; each counts only where the word it stands for may stand.
SYNONYMS = {
    **dict.fromkeys(("circle", "circular", "loop", "torus", "annulus", "closed"), "ring"),
    **dict.fromkeys(("line", "linear", "rod", "filament", "fiber", "fibre"), "straight"),
    **dict.fromkeys(("spiral", "coil", "helical"), "helix"),
    **dict.fromkeys(("wave", "sinus", "sinusoid", "sinusoidal"), "sine"),
    **dict.fromkeys(("table", "txt", "csv", "h5", "hdf5", "restart"), "file"),
    **dict.fromkeys(("mu", "eta", "dynamic_viscosity"), "viscosity"),
    **dict.fromkeys(("dt", "timestep", "time_step", "step_size"), "step"),
    **dict.fromkeys(("t_end", "tend", "tmax", "t_max", "t_final", "duration", "stop"), "end"),
    **dict.fromkeys(("tol", "rtol", "atol", "accuracy"), "tolerance"),
    **dict.fromkeys(("n", "nodes", "num_points", "n_points", "resolution"), "points"),
    **dict.fromkeys(("ds", "dx"), "spacing"),
    **dict.fromkeys(("curvature", "omega", "rest_curvature"), "strain_twist"),
    **{f"a{name}": f"arc{name}" for name in ("sin", "cos", "tan", "tan2")},
    **dict.fromkeys(("ln", "log10"), "log"),
    **dict.fromkeys(("unit_step", "theta"), "heaviside"),
    **dict.fromkeys(("if", "iif", "piecewise"), "where"),
    **dict.fromkeys(("rk", "runge_kutta"), "rk4"),
    "fabs": "abs",
    "sgn": "sign",
    "minimum": "min",
    "maximum": "max",
    "forward_euler": "euler",
}
LONGEST_WORD = 60  # comparing words is quadratic; nobody mistypes longer names than this
LONGEST_VALUE = 60
LONGEST_CIRCLE = 12  # names shown


def did_you_mean(word: str, choices: Iterable[str]) -> str:
    """Return ``": did you mean 'radius'?"`` for a near miss, else ``""``."""
    if len(word) > LONGEST_WORD:
        return ""
    lowered = {choice.lower(): choice for choice in choices}
    if SYNONYMS.get(word.lower()) in lowered:
        return f": did you mean '{lowered[SYNONYMS[word.lower()]]}'?"
    from difflib import get_close_matches  # not for who makes no mistake

    close = get_close_matches(word.lower(), lowered, n=1, cutoff=0.6)
    return f": did you mean '{lowered[close[0]]}'?" if close else ""


def one_of(choices: Iterable[str]) -> str:
    """Return ``a, b or c``."""
    *most, last = choices
    return f"{', '.join(most)} or {last}" if most else last


def circle(names: list[str], order: list[str]) -> tuple[str, str]:
    """Return the first in ``order`` of names that each need the next, and the words for them."""
    place = {name: index for index, name in enumerate(order)}
    first = min(names, key=place.get)
    turn = names.index(first)
    words = [clipped(name) for name in (*names[turn:], *names[:turn], first)]
    if len(words) > LONGEST_CIRCLE:
        words[LONGEST_CIRCLE - 1 : -1] = ["..."]
    return first, f"goes in a circle: {' -> '.join(words)}"


def clipped(text: str, most: int = LONGEST_VALUE) -> str:
    """Return the text on one line, without control characters, and not too long."""
    text = text if len(text) <= most else text[: most - 3] + "..."
    return printable(text).replace("\n", "\\n")


def dotted(path: Iterable[str | int]) -> str:
    """Return a path as users write it: ``rods.tail.strain_twist.0``."""
    return ".".join(clipped(str(part)) for part in path)


def shown(value: Any) -> str | None:
    """Return a value of a case file as YAML would have it, clipped; None for nothing."""
    return None if value is None else clipped(_yaml(value))


def _yaml(value: Any) -> str:
    if isinstance(value, dict):
        inside = (f"{key}: {_yaml(item)}" for key, item in list(value.items())[:LONGEST_VALUE])
        return "{" + ", ".join(inside) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_yaml(item) for item in value[:LONGEST_VALUE]) + "]"
    if isinstance(value, bool) or value is None:
        return {True: "true", False: "false", None: "null"}[value]
    return str(value)
