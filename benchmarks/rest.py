"""What searches for rest cost and where they end: the table of docs/rest.md."""

import time

from common import CONFIGS, benchmark, interleaved
from tables import Spread, Table

NARROW = "fluid.epsilon=0.314"
HELD = "contact={diameter: 0.381, strength: 20.0683, exclusion: 0.6}"
SCENES = {  # config, changes, whether saddles are kept, CPU s of another program
    "open rod": ("open_rod", (), False, 0.34),
    "ring, no contact": ("closed_ring", (NARROW,), False, 0.8),
    "ring, contact: the saddle": ("closed_ring", (NARROW, HELD), True, 2.1),
    "ring, contact": ("closed_ring", (NARROW, HELD), False, 2.4),
    "plectoneme": ("plectoneme", (NARROW, HELD), False, 2.9),
    "trefoil": ("trefoil", (), False, None),
    "ring of 1000, no contact": ("closed_ring", (NARROW, "rods.ring.shape.points=1000"), False,
                                 None),
}  # fmt: skip
COLUMNS = {"scene": "scene", "steps": "steps (refused)", "cpu": "CPU, s", "theirs": "other, s",
           "elastic": "elastic energy", "contact": "contact energy", "writhe": "writhe",
           "link": "Lk", "growing": "growing"}  # fmt: skip


@benchmark(full=5, short=1)
def main(quick, repeats):
    """Time searches from start to count of modes, in CPU time; all scenes in every round."""
    import numba

    numba.set_num_threads(1)
    found = {}
    searches = {name: search(found, name, *case) for name, case in SCENES.items()
                if not quick or name != "ring of 1000, no contact"}  # fmt: skip
    for run in searches.values():
        run()  # compiles
    seen = interleaved(searches, repeats, "searches")
    rows = [
        {"scene": name, **found[name], "cpu": Spread.of(times), "theirs": SCENES[name][3]}
        for name, times in seen.items()
    ]
    return [Table("Searches for rest", COLUMNS, rows)], lambda *axes: draw(rows, *axes)


def search(found, name, config, changes, saddle, _):
    """Return a function that finds a rest, writes what it is into ``found``: its CPU seconds."""
    from rodsim.case import load_case
    from rodsim.rest.forces import stored_energies
    from rodsim.rest.output import topology
    from rodsim.rest.solve import find_rest
    from rodsim.scene.build import build_scene

    scene = build_scene(load_case(CONFIGS / f"{config}.yaml", changes))

    def once():
        begin = time.process_time()
        rest = find_rest(scene, saddle=saddle)
        taken = time.process_time() - begin
        energies = stored_energies(scene, rest.state)
        held = energies.pop("contact", None)
        writhe, link = topology(scene, rest.state)[:, 0]
        found[name] = {
            "steps": f"{rest.steps} ({rest.rejected})",
            "elastic": f"{sum(energies.values()):.10g}",
            "contact": held if held is None else f"{held:.5g}",
            "writhe": f"{writhe:.6g}",
            "link": f"{link:.0f}",
            "growing": rest.growing,
        }
        return taken

    return once


def draw(rows, left, _):
    """Draw CPU seconds by scene."""
    left.barh([row["scene"] for row in rows], [row["cpu"].median for row in rows])
    left.set(xlabel="CPU, s")


if __name__ == "__main__":
    main()
