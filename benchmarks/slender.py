"""How low shear and stretch may be for a rod that hardly shears or stretches (docs/choosing.md).

    python benchmarks/slender.py [--markdown] [--plot FILE.png]

Two shipped scenes, with other shear or stretch moduli: how fast the flagellum swims, how far the
sedimenting fibre bows. What is not varied is at its stiffest. Errors are against both at their
stiffest; the last row, of half of that, says how good this is.
"""

import tempfile
from pathlib import Path

from common import CONFIGS, benchmark
from tables import Table

VALUES = (0.003125, 0.00625, 0.0125, 0.025, 0.05, 0.1, 0.2, 0.4, 0.8, 3.2)
STIFFEST = 12.8
FEWER = (
    "rods.tail.shape.points=150",
    "rods.tail.shape.spacing=40/150",
    "fluid.epsilon=0.5",
    "time.end=3*period",
)


def speed(run, case):
    """Return how fast a flagellum swims along its axis."""
    from rodsim.analysis.swimming import swimming_velocity

    return swimming_velocity(run.time, run.position, case.parameters["period"])[2]


def bow(run, case):
    """Return how far the ends of a fibre are above its middle."""
    z = run.position[-1, :, 2]
    return 0.5 * (z[0] + z[-1]) - z[len(z) // 2]


SCENES = {
    "flagellum": ("flagellum", "tail", FEWER, speed),
    "fibre": ("sedimenting_fibre", "fibre", (), bow),
}


@benchmark(full=1, short=1)
def main(quick, repeats):
    """What shear and stretch moduli change, and what they cost."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for scene in SCENES:
            rows += measure(Path(folder), scene, VALUES[::3] if quick else VALUES)
    columns = {
        "scene": "scene", "value": "modulus, g um s^-2", "shear": "error, shear (%)",
        "stretch": "error, stretch (%)", "both": "error, both (%)", "evaluations": "evaluations",
    }  # fmt: skip
    return [Table("Soft shear and stretch", columns, rows)], lambda *axes: draw(rows, *axes)


def measure(folder, scene, values):
    """Return a row for each value; the last one is of half the stiffest, against the stiffest."""
    wanted, _ = result(folder, scene, STIFFEST, STIFFEST)
    rows = []
    for value in (*values, STIFFEST / 2):
        pairs = {"shear": (value, STIFFEST), "stretch": (STIFFEST, value), "both": (value, value)}
        found = {key: result(folder, scene, *pair) for key, pair in pairs.items()}
        errors = {key: 100.0 * abs(got / wanted - 1.0) for key, (got, _) in found.items()}
        rows.append({"scene": scene, "value": value, "evaluations": found["both"][1], **errors})
    return rows


def result(folder, scene, shear, stretch):
    """Run a scene; return what is measured of it, and the evaluations."""
    from rodsim import load_case, open_trajectory, simulate

    config, rod, changes, measured = SCENES[scene]
    moduli = f"rods.{rod}.moduli.shear={shear}", f"rods.{rod}.moduli.stretch={stretch}"
    case = load_case(CONFIGS / f"{config}.yaml", [*changes, *moduli])
    simulate(case, folder / "out.h5", overwrite=True, notify=lambda text: None)
    with open_trajectory(folder / "out.h5") as run:
        return float(measured(run, case)), int(run.runtime["evaluations"])


def draw(rows, left, right):
    """Errors of each scene over the modulus."""
    for axis, scene in zip((left, right), SCENES, strict=True):
        some = [row for row in rows if row["scene"] == scene]
        for key in ("shear", "stretch", "both"):
            axis.loglog([row["value"] for row in some], [row[key] for row in some], "o-", label=key)
        axis.set_title(scene)
        axis.set_xlabel("modulus (g um s^-2)")
        axis.set_ylabel("error (%)")
        axis.legend()


if __name__ == "__main__":
    main()
