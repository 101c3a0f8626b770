"""What is known of the stability of a state, as lines and as a table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rodsim.rest.output import RATE, STIFFNESS
from rodsim.rest.rates import main_rates
from rodsim.rest.report import stability_lines
from rodsim.units import unit_text

MAIN = 2  # rates of a mode that are told, those with most of its energy
HEADS = ("mode", "stiffness", "rate", "share", "second rate", "second share")


@dataclass(frozen=True)
class ModeTable:
    """Lines about all modes, and rows of the lowest that are not neutral.

    rows : number, eigenvalue of K v = lambda W v, and where rates are known, the two at which most
    of the mode's energy decays, with their shares; ``nan`` else.
    """

    lines: list[str]
    heads: tuple[str, ...]
    rows: np.ndarray

    def text(self) -> str:
        """Return lines and table."""
        known = ~np.isnan(self.rows).all(axis=0) if len(self.rows) else []
        heads = [head for head, yes in zip(self.heads, known, strict=False) if yes]
        lines = [*self.lines, "  ".join(f"{head:>20}" for head in heads)] if heads else self.lines
        for row in self.rows:
            cells = [f"{value:20.7g}" for value, yes in zip(row, known, strict=True) if yes]
            lines = [*lines, "  ".join(cells)]
        return "\n".join(lines)

    def write_csv(self, path) -> None:
        """Write the table with full precision; raises FileError."""
        from rodsim.export.tables import write_csv

        write_csv(path, self.heads, [[*self.rows.T]])


def mode_table(found) -> ModeTable:
    """Return the :class:`ModeTable` of a :class:`rodsim.rest.stability.Stability`."""
    units = found.start.case.units.names
    rate, stiffness = unit_text(RATE, units), unit_text(STIFFNESS, units)
    heads = tuple(
        f"{head} ({unit})" if unit else head
        for head, unit in zip(HEADS, ("", stiffness, rate, "", rate, ""), strict=True)
    )
    lines = [f"residual {found.residual:.2g}"]
    if found.modes is None:
        return ModeTable([*lines, *_turning(found.rates, rate)], heads, np.zeros((0, len(HEADS))))
    lines += stability_lines(found.modes.growing, found.modes.neutral)
    if found.rates is not None and found.modes.growing:
        fastest = ", ".join(f"{v.real:.6g}" for v in found.rates.values[: found.modes.growing])
        lines.append(f"growth rates: {fastest} {rate}")
    if found.rates is not None and found.shares is None:
        lines.append("no shares: epsilon is so large that the mobility is singular in rounding")
    rows = np.full((len(found.modes.values), len(HEADS)), np.nan)
    for k, value in enumerate(found.modes.values):
        rows[k, :2] = k + 1, value
        if found.shares is not None:
            main = main_rates(found.rates, found.shares[k], MAIN)
            rows[k, 2 : 2 + 2 * len(main)] = np.ravel(main)
    return ModeTable(lines, heads, rows)


def _turning(rates, unit):
    """Return the lines on a state whose forces have no energy."""
    if rates is None:
        yield "a force has no energy: modes cannot be counted without --rates"
        return
    grown = rates.values[rates.values.real > 1e-6 * abs(rates.values).max()]
    yield f"growing modes: {len(grown)}"
    if len(grown):
        shown = ", ".join(f"{v.real:.6g}{v.imag:+.6g}i" for v in grown[:6])
        yield f"growth rates: {shown} {unit}"
