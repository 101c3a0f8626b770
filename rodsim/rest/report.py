"""What a search for rest shows: its progress, and what it has found, in words."""

from __future__ import annotations

import math

import numpy as np

from rodsim.progress import make_progress
from rodsim.units import unit_text

ENERGY = (1, 2, -2)


class Steps:
    """Progress on stderr, by how many decades the residual has fallen. A context manager."""

    def __init__(self, label: str, quiet: bool):
        self._progress, self._first, self._done = make_progress(label, quiet), None, 0.0

    def __enter__(self):
        self._progress.__enter__()
        return self

    def __exit__(self, *error):
        self._progress.__exit__(*error)

    def __call__(self, residual: float, steps: int, tolerance: float) -> None:
        """Show how far it has come."""
        self._first = self._first or residual
        whole = math.log(max(self._first, 10.0 * tolerance) / tolerance)
        self._done = max(self._done, 1.0 - math.log(max(residual, tolerance) / tolerance) / whole)
        self._progress.update(self._done, f"step {steps}, residual {residual:.2g}")


def describe(report) -> str:
    """Return the lines that tell what has been found."""
    rest, units = report.rest, report.start.case.units.names
    state = f"not at rest: {rest.failure}" if rest.failure else "at rest"
    lines = [
        f"{state}; residual {rest.residual:.2g}, tolerance {rest.tolerance:.2g}; "
        f"{rest.steps} steps, {rest.rejected} refused, {report.seconds:.1f} s"
    ]
    lines += _energies(report, unit_text(ENERGY, units))
    lines += _links(report)
    if not rest.failure:
        lines += stability_lines(rest.growing, rest.neutral)
    if rest.saddles:
        lines.append(f"left on the way: {rest.saddles} states at rest that are not stable")
    return "\n".join(lines)


def stability_lines(growing, neutral) -> list[str]:
    """Return the line on stability."""
    if growing is None:
        return ["growing modes: not counted, for a force has no energy: see rodsim stability"]
    kind = "stable" if growing == 0 else "NOT STABLE: a saddle"
    return [f"growing modes: {growing}, neutral: {neutral}; {kind}"]


def _energies(report, unit):
    """Return a line for each energy, before and after, and for their sum."""
    before, after = report.energies
    lines = [f"{'energy':>12} {'before':>13} {'after':>13}   {unit}"]
    for name in before:
        if before[name] or after[name]:
            lines.append(f"{name:>12} {before[name]:13.6e} {after[name]:13.6e}")
    total = sum(before.values()), sum(after.values())
    return [*lines, f"{'total':>12} {total[0]:13.6e} {total[1]:13.6e}"]


def _links(report):
    """Return a line for each closed rod: its linking number and writhe, before and after."""
    (wr, lk), (wr_after, lk_after) = report.topology
    for r, name in enumerate(report.start.scene.rods.names):
        if np.isfinite(lk[r]):
            yield (
                f"rod {name}: linking number {round(lk[r])} -> {round(lk_after[r])}, "
                f"writhe {wr[r]:.5f} -> {wr_after[r]:.5f}"
            )
            if abs(lk_after[r] - lk[r]) > 0.5:
                yield (
                    f"warning: the path led rod {name} through itself, which the fluid would not "
                    "let it: start from a run (rodsim rest out.h5)"
                )
