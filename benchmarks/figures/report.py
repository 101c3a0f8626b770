"""What a figure hands back: rows of "paper says / we get / agrees", pictures, data as CSV."""

import csv
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """A claim of the paper beside what was measured; ``agrees``: yes, no, or in part."""

    where: str
    claim: str
    found: str
    agrees: str


def verdict(holds) -> str:
    """Return yes or no for one condition; for several: in part, if only some of them hold."""
    try:
        results = [bool(item) for item in holds]
    except TypeError:
        results = [bool(holds)]
    return "yes" if all(results) else "in part" if any(results) else "no"


def markdown(rows) -> str:
    """Return the table of all rows."""
    lines = ["| | the paper says | we get | agrees |", "|---|---|---|---|"]
    lines += [f"| {row.where} | {row.claim} | {row.found} | {row.agrees} |" for row in rows]
    return "\n".join(lines)


def write_csv(path, columns: dict) -> None:
    """Write columns of equal length, by name."""
    with open(path, "w", newline="") as stream:
        out = csv.writer(stream)
        out.writerow(columns)
        for row in zip(*columns.values(), strict=True):
            out.writerow([v if isinstance(v, str) else f"{v:.8g}" for v in row])


def new_figure(width, height):
    """Return a matplotlib figure that needs no display."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def save(figure, path, dpi=90) -> None:
    """Write a picture small enough for a repository, below 150 kB."""
    figure.savefig(path, dpi=dpi)
