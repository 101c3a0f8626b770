"""Work against precision of the adaptive method: evaluations and largest error, by tolerance.

    python benchmarks/work_precision.py [SCENE ...] [--decades 2 7] [--per-decade 3]

The ring and the open rod are held against tests/reference, the flagellum against a run of itself
at a tolerance of 1e-9 (half a minute). Evaluations include rejected steps and power iterations.
Errors are in um at the end of the case. To compare two versions, run it with each on PYTHONPATH.
"""

import argparse
from collections import deque
from pathlib import Path
from time import perf_counter

import numpy as np

from rodsim.case import load_case
from rodsim.dynamics import RodSystem
from rodsim.integrators import make_integrator
from rodsim.rods import build_scene

ROOT = Path(__file__).parent.parent
SCENES = {"closed_ring": "closed-ring", "open_rod": "open-rod", "flagellum": None}
TIGHT = 1e-9


def run(scene: str, tolerance: float):
    """Return (last positions, system, integrator, seconds) of a shipped case."""
    case = load_case(ROOT / f"configs/{scene}.yaml", [f"time.tolerance={float(tolerance)!r}"])
    system = RodSystem(build_scene(case))
    integrator = make_integrator(case.time, system)
    start = perf_counter()
    (last,) = deque(integrator.steps(system.scene.initial, case.time.end), maxlen=1)
    return last.end.position, system, integrator, perf_counter() - start


def converged(scene: str) -> np.ndarray:
    """Return the end positions (3, M) that a scene is held against."""
    name = SCENES[scene]
    if name is None:
        return run(scene, TIGHT)[0]
    return np.loadtxt(ROOT / f"tests/reference/{name}.txt")[:, :3].T


def table(scene: str, tolerances) -> None:
    """Print a line for each tolerance."""
    exact = converged(scene)
    print(f"{scene}\n{'tolerance':>10}{'evaluations':>13}{'error/um':>10}{'steps':>7}"
          f"{'rejected':>10}{'stages':>8}{'seconds':>9}")  # fmt: skip
    for tolerance in tolerances:
        position, system, done, seconds = run(scene, tolerance)
        error = abs(position - exact).max()
        print(f"{tolerance:10.1e}{system.evaluations:13d}{error:10.1e}{done.accepted:7d}"
              f"{done.rejected:10d}{done.max_stages:8d}{seconds:9.2f}", flush=True)  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=", ".join(SCENES))
    parser.add_argument("--decades", nargs=2, type=float, default=(2.0, 7.0))
    parser.add_argument("--per-decade", type=int, default=3)
    options = parser.parse_args()
    low, high = options.decades
    count = round((high - low) * options.per_decade) + 1
    for scene in options.scenes or SCENES:
        table(scene, 10.0 ** -np.linspace(low, high, count))


if __name__ == "__main__":
    main()
