"""A flagellum swimming along a wall, over its height: speed and attraction (docs/wall.md).

    python benchmarks/swimmer_at_wall.py [--markdown] [--plot FILE.png]

The scene is ``configs/swimmer_at_wall.yaml``; its wave stands upright on the wall, or lies parallel
to it. Velocities are those of the centroid over the periods after the first. The attraction is the
change of the velocity away from the wall by the wall: an upright wave drifts without one too.
"""

import tempfile
from pathlib import Path

import numpy as np
from common import CONFIGS, benchmark
from tables import Table

HEIGHTS = (0.6, 0.8, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0)
WAVES = {
    "upright": (),
    "parallel": ("plane=null", "rods.tail.strain_twist=[0, '-k**2*b*sin(k*s + sigma*t)', 0]"),
}


def velocity(folder: Path, *changes) -> tuple[np.ndarray, float]:
    """Run the scene with changes; return the velocity of its centroid, and how low it came."""
    from rodsim import load_case, open_trajectory, simulate
    from rodsim.analysis.swimming import swimming_velocity

    case = load_case(CONFIGS / "swimmer_at_wall.yaml", changes)
    simulate(case, folder / "out.h5", overwrite=True, notify=lambda text: None)
    with open_trajectory(folder / "out.h5") as run:
        found = swimming_velocity(run.time, run.position, case.parameters["period"])
        return found, float(run.position[..., 2].min())


@benchmark(full=1, short=1)
def main(quick, repeats):
    """Speed and attraction of a flagellum over its height above a wall."""
    rows = []
    with tempfile.TemporaryDirectory() as name:
        for wave, changes in WAVES.items():
            free, _ = velocity(Path(name), "fluid.wall=null", *changes)
            rows.append({"wave": wave, "height": "no wall", "speed": free[1], "ratio": 1.0})
            for height in HEIGHTS[::4] if quick else HEIGHTS:
                at_wall, lowest = velocity(Path(name), f"parameters.height={height}", *changes)
                rows.append({
                    "wave": wave, "height": height, "lowest": lowest, "speed": at_wall[1],
                    "ratio": at_wall[1] / free[1], "attraction": free[2] - at_wall[2],
                })  # fmt: skip
    columns = {
        "wave": "wave", "height": "height, um", "lowest": "lowest point, um",
        "speed": "speed, um/s", "ratio": "speed over that without a wall",
        "attraction": "attraction, um/s",
    }  # fmt: skip
    return [Table("Flagellum along a wall", columns, rows)], lambda *axes: draw(rows, *axes)


def draw(rows, left, right):
    """Speed over that without a wall, and attraction, over the height."""
    for wave, marker in zip(WAVES, "os", strict=True):
        mine = [row for row in rows if row["wave"] == wave and "attraction" in row]
        heights = [row["height"] for row in mine]
        left.semilogx(heights, [row["ratio"] for row in mine], marker=marker, label=wave)
        attraction = np.array([row["attraction"] for row in mine])
        right.loglog(heights, np.where(attraction > 0, attraction, np.nan), marker=marker)
    left.set_ylabel("swimming speed, over that without a wall")
    right.set_ylabel("attraction (µm/s)")
    for axis in (left, right):
        axis.set_xlabel("height above the wall (µm)")
        axis.grid(color="0.9")
    left.legend(title="plane of the wave", frameon=False)


if __name__ == "__main__":
    main()
