"""Work against precision of the adaptive method: evaluations and largest error, by tolerance.

    python benchmarks/work_precision.py [SCENE ...] [--decades 2 7] [--per-decade 3]
    python benchmarks/work_precision.py --all [SCENE ...] [--budget 60] [-o work-precision]

The ring and the open rod are held against tests/reference, the flagellum against a run of itself
at a tolerance of 1e-9 (half a minute). Evaluations include rejected steps and estimates of the
fastest rate. Errors are in um at the end of the case. To compare two versions, run it with each on
PYTHONPATH.
For a scene of your own, `rodsim converge` makes its own reference.

With --all: every shipped scene, beside forward Euler and RK4, in one table and one picture
(all_scenes.py).
"""

import argparse
from pathlib import Path

import numpy as np

from rodsim.compiled.settings import prepare

prepare()  # the command's settings; before Numba is imported

import all_scenes  # noqa: E402

from rodsim.case import load_case  # noqa: E402
from rodsim.convergence.outcome import Outcome, solve  # noqa: E402

ROOT = Path(__file__).parent.parent
SCENES = {"closed_ring": "closed-ring", "open_rod": "open-rod", "flagellum": None}
TIGHT = 1e-9


def run(scene: str, tolerance: float) -> Outcome:
    """Run a shipped case at a tolerance."""
    return solve(
        load_case(ROOT / f"configs/{scene}.yaml", [f"time.tolerance={float(tolerance)!r}"])
    )


def converged(scene: str) -> np.ndarray:
    """Return the end positions (3, M) that a scene is held against."""
    name = SCENES[scene]
    if name is None:
        return run(scene, TIGHT).end.position
    return np.loadtxt(ROOT / f"tests/reference/{name}.txt")[:, :3].T


def table(scene: str, tolerances) -> None:
    """Print a line for each tolerance."""
    exact = converged(scene)
    print(f"{scene}\n{'tolerance':>10}{'evaluations':>13}{'error/um':>10}{'steps':>7}"
          f"{'rejected':>10}{'seconds':>9}")  # fmt: skip
    for tolerance in tolerances:
        done = run(scene, tolerance)
        error = abs(done.end.position - exact).max()
        print(f"{tolerance:10.1e}{done.evaluations:13d}{error:10.1e}{done.steps:7d}"
              f"{done.rejected:10d}{done.seconds[0]:9.2f}", flush=True)  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=", ".join(SCENES))
    parser.add_argument("--decades", nargs=2, type=float, default=(2.0, 7.0))
    parser.add_argument("--per-decade", type=int, default=3)
    parser.add_argument("--all", action="store_true", help="all shipped scenes, or those named")
    parser.add_argument("--budget", type=float, default=60.0, help="seconds for a scene, about")
    parser.add_argument("-o", "--output", default="work-precision", help="name of .csv and .png")
    parser.add_argument("--from", nargs="+", default=[], dest="paths", metavar="CSV",
                        help="table and picture of what was measured before")  # fmt: skip
    options = parser.parse_args()
    if options.all:
        all_scenes.main(options.scenes, options.budget, options.output, options.paths)
        return
    low, high = options.decades
    count = round((high - low) * options.per_decade) + 1
    for scene in options.scenes or SCENES:
        table(scene, 10.0 ** -np.linspace(low, high, count))


if __name__ == "__main__":
    main()
