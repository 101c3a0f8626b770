"""What ``rodsim info`` says a run will cost, against what it costs (docs/choosing.md).

    python benchmarks/forecast.py [--markdown] [--plot FILE.png]

All shipped cases, and some of them tighter, longer or with a fixed step. Seconds are those of steps
and frames, without the start; forecast and run are processes of their own, one after the other.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from child import run_python
from common import CONFIGS, benchmark
from tables import Table

ASK = """
import json, sys, rodsim
from rodsim.compiled.settings import prepare
prepare()
from rodsim.run.forecast import forecast
from rodsim.run.machine import Machine
from rodsim.scene.build import build_scene
case = rodsim.load_case(sys.argv[1], sys.argv[2:])
cost = forecast(Machine(case, build_scene(case), False))
keys = "seconds", "evaluations", "memory", "disk"
print(json.dumps({key: getattr(cost, key) for key in keys}))
"""
VARIANTS = (
    ("flagellum", "time.tolerance=1e-6"),
    ("flagellum", "time.end=20*period"),
    ("closed_ring", "time.tolerance=1e-6"),
    ("closed_ring", "time.end=1"),
    ("open_rod", "time.end=0.5"),
    ("open_rod", "time.tolerance=1e-7"),
    ("fibre_in_shear", "time.tolerance=1e-6"),
    ("tethered_pair", "time.tolerance=1e-6"),
    ("open_rod", "time.tolerance=null", "time.integrator=rk4", "time.step=1e-6"),
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
        "seconds": "s", "seconds_ratio": "forecast over that", "memory": "memory, MB",
        "memory_ratio": "forecast over that", "disk": "output, MB",
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
    from rodsim import open_trajectory

    case, output = str(CONFIGS / f"{name}.yaml"), folder / "out.h5"
    command = [sys.executable, "-c", ASK, case, *changes]
    said = json.loads(subprocess.run(command, capture_output=True, check=True, text=True).stdout)
    options = [word for change in changes for word in ("--set", change)]
    arguments = ["-m", "rodsim", "run", case, "-q", "-o", output, "--overwrite", *options]
    child = run_python(arguments, folder)
    with open_trajectory(output) as run:
        cost = run.runtime
    found = {
        "seconds": cost["solve_seconds"] + cost["output_seconds"],
        "evaluations": int(cost["evaluations"]),
        "memory": 1024 * child.peak_kb,
        "disk": output.stat().st_size,
    }
    ratios = {f"{key}_ratio": said[key] / value for key, value in found.items()}
    found |= {key: found[key] / 1e6 for key in ("memory", "disk")}
    return {"case": " ".join((name, *changes)), **found, **ratios}


if __name__ == "__main__":
    main()
