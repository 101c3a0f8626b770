"""The paper's ring of Fig. 4 long after the paper's end: with and without contact."""

import numpy as np

from figures.report import Row, new_figure, save, verdict, write_csv
from rodsim import open_trajectory
from rodsim.analysis.energy import energy_table
from rodsim.analysis.topology import twist, writhe

CASES = {"without contact": "contact=null", "with contact": "contact={}"}


def late_ring(place) -> list[Row]:
    """Energy, writhe and gap to 10 s."""
    end = 1.0 if place.quick else 10.0
    found = {
        name: _history(
            place.run(f"late-{key[8]}", "closed_ring", key, f"time.end={end}",
                      f"output.interval={0.02 if not place.quick else 0.05}")
        )
        for name, key in CASES.items()
    }  # fmt: skip
    _draw(place.path("late.png"), found)
    write_csv(place.path("late.csv"), {
        f"{column}, {name}": values for name, columns in found.items()
        for column, values in columns.items()
    })  # fmt: skip
    return [_row(found, end)]


def _history(output):
    """Return time, energies, writhe, linking number and gap of all frames."""
    table = energy_table(output)
    with open_trajectory(output) as run:
        shapes = [(run.read("position", f), run.read("director", f)) for f in range(run.frames)]
        wound = np.array([writhe(X) for X, _ in shapes])
        turned = np.array([twist(X, D) for X, D in shapes])
        return {
            "time (s)": run.time,
            "energy (g um^2 s^-2)": table.rows[:, table.columns.index("total")],
            "writhe": wound,
            "linking number": wound + turned,
            "gap (um)": run.observable("gap"),
        }


def _draw(path, found):
    figure = new_figure(10.0, 3.0)
    for place, (column, label) in enumerate(
        (("energy (g um^2 s^-2)", "energy (1e-3 g µm² s⁻²)"), ("writhe", "writhe"),
         ("gap (um)", "gap (µm)")), 1
    ):  # fmt: skip
        axes = figure.add_subplot(1, 3, place)
        for (name, columns), line in zip(found.items(), ("--", "-"), strict=True):
            scale = 1e3 if place == 1 else 1.0
            axes.plot(columns["time (s)"][1:], scale * columns[column][1:], line, label=name)
        axes.set(xscale="log", xlabel="t (s)", ylabel=label)
        if place == 1:
            axes.set_ylim(6.1, 9.0)
    axes.set_yscale("log")
    axes.legend(frameon=False)
    save(figure, path, dpi=75)


def _row(found, end):
    """Whether the coil comes to rest: what its energy still falls over the last half of the run."""
    said, rests = [], {}
    for name, columns in found.items():
        time, energy, gap = (columns[key] for key in ("time (s)", "energy (g um^2 s^-2)",
                                                      "gap (um)"))  # fmt: skip
        half = int(np.argmin(abs(time - 0.5 * end)))
        fallen = energy[half] - energy[-1]
        rests[name] = bool(fallen < 1e-6 * energy[-1])
        link = abs(columns["linking number"]).max()
        said.append(
            f"{name} energy {energy[-1]:.6f}, writhe {columns['writhe'][-1]:.4f}, gap "
            f"{gap[-1]:.4f} um, energy fallen by {fallen:.1g} since {time[half]:g} s, "
            f"linking number 0 (to {link:.0e})"
        )
    return Row(
        "Fig. 4",
        f"(not in the paper) at {end:g} s the coil is at rest",
        "; ".join(said),
        verdict(list(rests.values())),
    )
