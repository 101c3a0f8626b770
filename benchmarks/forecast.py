"""What ``rodsim info`` says a run will cost, against what it costs (docs/choosing.md).

    python benchmarks/forecast.py [--markdown] [--plot FILE.png]

All shipped cases, and some of them tighter or longer, on one thread. Seconds are those of steps and
frames, without the start; both come one after the other, so that a neighbour slows both.
"""

import tempfile
from pathlib import Path

from common import CONFIGS, benchmark
from tables import Table

VARIANTS = (
    ("flagellum", "time.tolerance=1e-6"),
    ("flagellum", "time.end=20*period"),
    ("closed_ring", "time.tolerance=1e-6"),
    ("closed_ring", "time.end=1"),
    ("open_rod", "time.end=0.5", "output.interval=5e-3"),
    ("open_rod", "time.tolerance=1e-7"),
    ("fibre_in_shear", "time.tolerance=1e-6"),
    ("tethered_pair", "time.tolerance=1e-6"),
)


@benchmark(full=1, short=1)
def main(quick, repeats):
    """Forecasts of the cost of runs against their cost."""
    cases = [(path.stem,) for path in sorted(CONFIGS.glob("*.yaml"))]
    with tempfile.TemporaryDirectory() as folder:
        chosen = cases[::4] if quick else [*cases, *VARIANTS]
        rows = [compare(Path(folder), *case) for case in chosen]
    columns = {
        "case": "case", "evaluations": "evaluations", "evaluations_ratio": "forecast over that",
        "seconds": "s", "seconds_ratio": "forecast over that", "disk": "output, MB",
        "disk_ratio": "forecast over that",
    }  # fmt: skip
    return [Table("Forecast and run", columns, rows)], lambda *axes: draw(rows, *axes)


def draw(rows, left, right):
    """Forecast over run: evaluations and seconds, over those of the run."""
    for axis, key in ((left, "evaluations"), (right, "seconds")):
        axis.loglog([row[key] for row in rows], [row[f"{key}_ratio"] for row in rows], "o")
        axis.axhspan(0.5, 2.0, color="0.9", zorder=0)
        axis.set_xlabel(f"{key} of the run")
        axis.set_ylabel("forecast over that")


def compare(folder: Path, name: str, *changes) -> dict:
    """Ask for a forecast, run the case, and return a row with both."""
    from rodsim import load_case, simulate
    from rodsim.run.forecast import forecast
    from rodsim.run.machine import Machine
    from rodsim.scene.build import build_scene

    case, output = load_case(CONFIGS / f"{name}.yaml", changes), folder / "out.h5"
    said = forecast(Machine(case, build_scene(case), False), threads=1)
    summary = simulate(case, output, overwrite=True, threads=1, notify=lambda text: None)
    cost = summary.runtime
    found = {
        "seconds": cost["solve_seconds"] + cost["output_seconds"],
        "evaluations": int(cost["evaluations"]),
        "disk": output.stat().st_size,
    }
    ratios = {f"{key}_ratio": getattr(said, key) / value for key, value in found.items()}
    return {"case": " ".join((name, *changes)), **found, "disk": found["disk"] / 1e6, **ratios}


if __name__ == "__main__":
    main()
