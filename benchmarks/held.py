"""What held ends and bodies cost in one evaluation, beside the same rod without them."""

from time import perf_counter

from common import benchmark
from tables import Table

ROD = {
    "shape": {"kind": "straight", "points": 100, "length": 5.0},
    "moduli": {"bending": 1.3, "twisting": 1.2, "shear": 120.0, "stretch": 130.0},
    "strain_twist": [0.2, 0.1, 0.3],
}
COLUMNS = {"scene": "scene", "time": "an evaluation, us", "more": "more than the rod, us",
           "ratio": "times the rod"}  # fmt: skip
CALLS = 50  # of one scene, one after another


@benchmark(full=60, short=10)
def main(quick, repeats):
    """Time evaluations at the start of each scene, serial; all scenes in every round."""
    import numba

    numba.set_num_threads(1)
    systems = {name: system_of(case) for name, case in scenes(quick).items()}
    best = dict.fromkeys(systems, float("inf"))
    for _ in range(repeats):
        for name, (system, still, out) in systems.items():
            for _ in range(CALLS):
                start = perf_counter()
                system.velocities(0.0, system.scene.initial, still, out)
                best[name] = min(best[name], perf_counter() - start)
    alone = best["rod"]
    rows = [
        {"scene": name, "time": 1e6 * t, "more": 1e6 * (t - alone), "ratio": t / alone}
        for name, t in best.items()
    ]
    return [Table("Held ends and bodies", COLUMNS, rows)], lambda *axes: draw(rows, *axes)


def scenes(quick):
    """Return cases by name."""
    found = {
        "rod": case(ROD),
        "held at one end": case({**ROD, "start": {"hold": "clamped"}}),
        "held at both": case({**ROD, "start": {"hold": "clamped"}, "end": {"hold": "hinged"}}),
    }
    for points in (50, 100) if quick else (50, 100, 200, 400):
        body = {"shape": {"kind": "sphere", "radius": 1.1, "points": points,
                          "origin": [0.0, 0.0, -1.1]}}  # fmt: skip
        held = {**ROD, "start": {"hold": "clamped", "to": "cell"}}
        found[f"body of {points} points"] = case(held, {"cell": body})
    return found


def case(rod, bodies=None):
    """Return the data of a case of one rod."""
    data = {"fluid": {"viscosity": 0.7, "epsilon": 0.11}, "rods": {"rod": rod},
            "time": {"end": 2.0}}  # fmt: skip
    return data | ({"bodies": bodies} if bodies else {})


def system_of(data):
    """Return a system and room for increments and velocities."""
    from rodsim.case import case_from_mapping
    from rodsim.scene.build import build_scene
    from rodsim.scene.system import RodSystem

    system = RodSystem(build_scene(case_from_mapping(data)))
    return system, system.zeros(), system.zeros()


def draw(rows, axis, *_):
    """Draw the times as bars."""
    axis.barh([row["scene"] for row in rows], [row["time"] for row in rows])
    axis.set_xlabel("an evaluation (µs)")
    axis.invert_yaxis()


if __name__ == "__main__":
    main()
