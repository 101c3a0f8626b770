"""What contact costs beside the sums, in a scene where nothing touches and in a plectoneme."""

import time

import click
import numpy as np
from common import CONFIGS, Timed, benchmark, interleaved
from tables import Spread, Table

SIZES, LARGE = (200, 400, 1000, 2000), (10_000, 100_000, 1_000_000)
COLUMNS = {
    "scene": "scene",
    "points": "M",
    "pairs": "pairs",
    "contact": "contact, us",
    "sum": "sum over all pairs, us",
    "share": "contact / sum",
}
LARGE_COLUMNS = {"points": "M", "contact": "contact, us",
                 "each": "us a point"}  # fmt: skip


@benchmark(full=21, short=5)
@click.option("--largest", type=int, default=100_000, show_default=True, help="Points of the coil.")
def main(quick, repeats, largest):
    """Time the part of contact and the sums, serial, CPU time; both of a pair in every round."""
    wound, rows = plectoneme(), []
    for points in SIZES[: 2 if quick else None]:
        for scene, position in (("ring", ring(points)), ("plectoneme", on_curve(wound, points))):
            rows.append(row(scene, points, position, repeats))
    large = [large_row(points, repeats) for points in LARGE if points <= largest]
    tables = [Table("Contact and the sums", COLUMNS, rows)]
    tables.append(Table("Contact alone: a long coil", LARGE_COLUMNS, large))
    return tables, lambda *axes: draw(rows, large, *axes)


def plectoneme():
    """Return the centreline (3, M) of the shipped plectoneme once it is wound."""
    from rodsim.case import load_case
    from rodsim.convergence.outcome import solve

    case = load_case(CONFIGS / "plectoneme.yaml", ["time.end=0.03", "output.interval=0.03"])
    return solve(case, threads=1).end.position


def ring(points):
    """Return a circle (3, M) of the size of the plectoneme's ring."""
    angle = 2 * np.pi * np.arange(points) / points
    return 2.5 * np.array([np.cos(angle), np.sin(angle), 0 * angle])


def on_curve(curve, points):
    """Return so many points along a closed curve, straight between its own."""
    own = np.arange(curve.shape[1] + 1)
    at = np.arange(points) * curve.shape[1] / points
    return np.array([np.interp(at, own, np.append(x, x[0])) for x in curve])


def evaluators(position, points):
    """Return functions that evaluate contact and the sums of a ring's points at a position."""
    from dataclasses import replace

    import numba

    from rodsim.case import load_case
    from rodsim.compiled.parts import PartList
    from rodsim.forces.near import pairs_within
    from rodsim.scene.build import build_scene
    from rodsim.scene.evaluation import Evaluation

    case = load_case(CONFIGS / "plectoneme.yaml", [
        f"rods.ring.shape.points={points}", "fluid.epsilon=0.314159"])  # fmt: skip
    scene = build_scene(case)
    state = replace(scene.initial, position=np.ascontiguousarray(position))
    loads, still = np.zeros((6, points)), np.zeros((3, 0))

    def evaluate(name):
        parts = Evaluation(scene, PartList(p for p in scene.parts.of("force", "flow")
                                           if p.name == name))  # fmt: skip

        def once():
            numba.set_num_threads(1)
            parts.add(state, loads, np.zeros_like(loads), still)

        return once

    apart = scene.parts.apart
    near = pairs_within(state.position, scene.rods, apart.excluded, apart.diameter)
    return {name: evaluate(name) for name in ("contact", "fluid", "nothing")}, len(near[0])


def row(scene, points, position, repeats):
    """Return one row of the table; what an evaluation of no part takes is not counted."""
    works, pairs = evaluators(position, points)
    timers = {name: Timed(work, clock=time.process_time) for name, work in works.items()}
    times = {name: np.array(seen) for name, seen in
             interleaved(timers, repeats, f"{scene}, {points}").items()}  # fmt: skip
    contact, fluid = (times[name] - times["nothing"] for name in ("contact", "fluid"))
    return {"scene": scene, "points": points, "pairs": pairs, "contact": Spread.of(contact, 1e6),
            "sum": Spread.of(fluid, 1e6), "share": Spread.of(contact / fluid)}  # fmt: skip


def large_row(points, repeats):
    """Return one row of a coil whose turns touch: 20 points in a turn, 5 in a diameter."""
    from rodsim.forces.repulsion import pair_energies

    angle = 0.3 * np.arange(points)
    position = np.array([np.cos(angle), np.sin(angle), 0.9 * 1.5 * angle / (2 * np.pi)])
    tables = (np.zeros(1, np.int64), np.array([points]), np.zeros(1, bool), np.array([0.3]),
              np.ones((6, 1)))  # fmt: skip
    fixed = np.concatenate([[1.5, 1.0, 8.0], np.full(points, 0.3)])
    out = np.zeros(1)
    timer = Timed(lambda: pair_energies(fixed, tables, position, out), clock=time.process_time)
    seen = np.array(interleaved({"contact": timer}, repeats, f"coil, {points}")["contact"])
    return {"points": points, "contact": Spread.of(seen, 1e6),
            "each": Spread.of(seen, 1e6 / points)}  # fmt: skip


def draw(rows, large, left, right):
    """Left: the share of contact; right: the time of contact over the points."""
    for scene, marker in (("ring", "o"), ("plectoneme", "s")):
        chosen = [r for r in rows if r["scene"] == scene]
        points = [r["points"] for r in chosen]
        left.loglog(points, [r["share"].median for r in chosen], marker=marker, label=scene)
        right.loglog(points, [r["contact"].median for r in chosen], marker=marker, label=scene)
    right.loglog([r["points"] for r in large], [r["contact"].median for r in large], "^-",
                 label="a long coil")  # fmt: skip
    left.set(xlabel="points", ylabel="contact / sums")
    right.set(xlabel="points", ylabel="us")
    right.legend()


if __name__ == "__main__":
    main()
